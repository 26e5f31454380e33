"""Parameters of ``roverlink odometry``: frames, the driving board, and the sizes of the errors."""

from __future__ import annotations

import logging
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from roverkit.driving.board_commands import DrivingBoard
from roverkit.node.declared_parameters import DefaultedParameters
from roverkit.odometry.dead_reckoning import OdometryNoise
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.interfaces.rcl_interfaces import ParameterValue
from roverlink.runtime.ros_arguments.ros_args import RosArguments

_NUMBER, _BOOL, _TEXT = ParameterValue.DOUBLE, ParameterValue.BOOL, ParameterValue.STRING
_NOISE = asdict(OdometryNoise())

PARAMETERS: Mapping[str, tuple[float | bool | str, int, str]] = {
    "odom_frame": ("odom", _TEXT, "frame in which the pose of the rover is"),
    "base_frame": ("base_link", _TEXT, "frame of the rover"),
    "publish_tf": (True, _BOOL, "true to publish the transform from odom_frame to base_frame on /tf"),
    "smallest_radius": (1.0, _NUMBER, "smallest turning radius of the driving board in metres"),
    "straight_radius": (0.0, _NUMBER, "turning_radius in metres that the driving board takes for a straight line"),
    "slip": (_NOISE["slip"], _NUMBER, "standard deviation of the distance in metres, after one metre"),
    "side_slip": (_NOISE["side_slip"], _NUMBER, "standard deviation of the motion to the side, after one metre"),
    "yaw_slip": (_NOISE["yaw_slip"], _NUMBER, "standard deviation of the turn in radians, after one metre without IMU"),
    "gyro_noise": (_NOISE["gyro_noise"], _NUMBER, "noise density of the gyroscope, in rad/s per square root of Hz"),
    "gyro_bias": (_NOISE["gyro_bias"], _NUMBER, "standard deviation of its bias at the start, in rad/s"),
    "gyro_bias_walk": (_NOISE["gyro_bias_walk"], _NUMBER, "change of its bias in rad/s, after one second"),
}
"""Default value, type and description of each parameter."""


@dataclass(frozen=True, slots=True)
class OdometrySettings:
    """Meaning of the parameters."""

    odom_frame: str
    base_frame: str
    publish_tf: bool
    board: DrivingBoard
    noise: OdometryNoise


class OdometryParameters(DefaultedParameters[OdometrySettings]):
    """Parameters of the node."""

    def __init__(self, ros: RosArguments, logger: logging.Logger) -> None:
        """Read the first values. Raises `SetupError` if one of them is not possible."""
        super().__init__(PARAMETERS, ros, _read, logger)


def _read(values: Mapping[str, Any]) -> OdometrySettings:
    for name, (_, type_, _) in PARAMETERS.items():
        if type_ == _NUMBER and not 0 <= values[name] < math.inf:
            raise SetupError(f"the parameter {name!r} is {values[name]}; it must be 0 or more")
    frames = values["odom_frame"], values["base_frame"]
    if not all(frames) or frames[0] == frames[1]:
        raise SetupError(f"the parameters odom_frame and base_frame are {frames}; they must be two names")
    return OdometrySettings(
        *frames,
        values["publish_tf"],
        DrivingBoard(values["smallest_radius"], straight_radius=values["straight_radius"]),
        OdometryNoise(**{name: values[name] for name in _NOISE}),
    )
