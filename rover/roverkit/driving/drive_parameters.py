"""Parameters of ``roverlink drive``: limits and times, which ROS 2 can change."""

from __future__ import annotations

import logging
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from roverkit.driving.board_commands import DrivingBoard
from roverkit.driving.drive_control import DriveSettings
from roverkit.node.declared_parameters import DefaultedParameters
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.interfaces.rcl_interfaces import ParameterValue
from roverlink.runtime.ros_arguments.ros_args import RosArguments

_DEFAULTS = DriveSettings()
_NUMBER, _BOOL, _TEXT = ParameterValue.DOUBLE, ParameterValue.BOOL, ParameterValue.STRING

PARAMETERS: Mapping[str, tuple[float | bool | str, int, str]] = {
    "speed": (_DEFAULTS.speed, _NUMBER, "largest speed in m/s; also the speed on a path"),
    "acceleration": (_DEFAULTS.acceleration, _NUMBER, "largest change of the speed in m/s^2"),
    "smallest_radius": (
        _DEFAULTS.board.smallest_radius,
        _NUMBER,
        "smallest turning radius of the driving board in metres",
    ),
    "reverse": (_DEFAULTS.board.reverses, _BOOL, "true if the driving board drives backwards"),
    "straight_radius": (
        _DEFAULTS.board.straight_radius,
        _NUMBER,
        "turning_radius in metres that the driving board takes for a straight line",
    ),
    "rate": (
        1 / _DEFAULTS.period,
        _NUMBER,
        "commands a second; a velocity that differs from the last one sent is also sent at once",
    ),
    "horizon": (_DEFAULTS.horizon, _NUMBER, "time in seconds for which a command is enough"),
    "timeout": (_DEFAULTS.timeout, _NUMBER, "time in seconds without a velocity after which the rover stops"),
    "mode_timeout": (
        _DEFAULTS.mode_timeout,
        _NUMBER,
        "time in seconds without control_mode after which the mode is manual; 0: never",
    ),
    "pose_timeout": (_DEFAULTS.pose_timeout, _NUMBER, "age in seconds of the newest pose at which the rover is lost"),
    "pose_deviation": (
        _DEFAULTS.pose_deviation,
        _NUMBER,
        "standard deviation of the position in metres at which the rover is lost",
    ),
    "velocity_needs_pose": (
        _DEFAULTS.velocity_needs_pose,
        _BOOL,
        "true if velocities, too, are executed only while the rover is not lost",
    ),
    "lookahead": (
        _DEFAULTS.lookahead,
        _NUMBER,
        "distance in metres to the point of a path at which the rover aims",
    ),
    "goal_tolerance": (
        _DEFAULTS.goal_tolerance,
        _NUMBER,
        "distance in metres to the end of a path at which the rover stops",
    ),
    "base_frame": ("base_link", _TEXT, "frame of the rover, for which velocities and poses are"),
}
"""Default value, type and description of each parameter."""
_MAY_BE_ZERO = frozenset({"smallest_radius", "straight_radius", "mode_timeout"})
_PERIODS = 2
"""Commands that must fit into the time for which one is enough, so that a lost one does not stop the rover."""


@dataclass(frozen=True, slots=True)
class DriveProgramSettings:
    """Meaning of the parameters."""

    control: DriveSettings
    base_frame: str


class DriveParameters(DefaultedParameters[DriveProgramSettings]):
    """Parameters of the node."""

    def __init__(self, ros: RosArguments, logger: logging.Logger) -> None:
        """Read the first values. Raises `SetupError` if one of them is not possible."""
        super().__init__(PARAMETERS, ros, _read, logger)


def _read(values: Mapping[str, Any]) -> DriveProgramSettings:
    for name, (_, type_, _) in PARAMETERS.items():
        value = values[name]
        if type_ == _NUMBER and not (0 < value < math.inf or (value == 0 and name in _MAY_BE_ZERO)):
            least = "0 or more" if name in _MAY_BE_ZERO else "above 0"
            raise SetupError(f"the parameter {name!r} is {value}; it must be {least}")
    if values["horizon"] * values["rate"] < _PERIODS:
        raise SetupError(
            f"the parameter 'horizon' is {values['horizon']} s; it must be at least {_PERIODS} / rate = "
            f"{_PERIODS / values['rate']:g} s, or the rover stops when one command is lost"
        )
    own = dict(values)
    board = DrivingBoard(own.pop("smallest_radius"), own.pop("reverse"), own.pop("straight_radius"))
    limits = {name: own[name] for name in DriveSettings.__dataclass_fields__ if name in own}
    return DriveProgramSettings(DriveSettings(board, period=1 / own["rate"], **limits), own["base_frame"])
