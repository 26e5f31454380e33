"""Parameters of ``roverlink odometry``: frames, the driving board, and the sizes of the errors."""

from __future__ import annotations

import logging
import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from roverkit.driving.board_commands import DrivingBoard
from roverkit.node.declared_parameters import DeclaredParameters
from roverkit.odometry.dead_reckoning import OdometryNoise
from roverkit.odometry.odometry_declaration import NODE
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.ros_arguments.ros_args import RosArguments


@dataclass(frozen=True, slots=True)
class OdometrySettings:
    """Meaning of the parameters."""

    odom_frame: str
    base_frame: str
    publish_tf: bool
    distance_scale: float
    board: DrivingBoard
    noise: OdometryNoise


class OdometryParameters(DeclaredParameters[OdometrySettings]):
    """Parameters of the node."""

    def __init__(self, ros: RosArguments, logger: logging.Logger) -> None:
        """Read the first values. Raises `SetupError` if one of them is not possible."""
        super().__init__(NODE.parameters, {}, ros, _read, logger)


def _read(values: Mapping[str, Any]) -> OdometrySettings:
    for parameter in NODE.parameters:
        if parameter.type is float and not 0 <= values[parameter.name] < math.inf:
            raise SetupError(f"the parameter {parameter.name!r} is {values[parameter.name]}; it must be 0 or more")
    frames = values["odom_frame"], values["base_frame"]
    if not all(frames) or frames[0] == frames[1]:
        raise SetupError(f"the parameters odom_frame and base_frame are {frames}; they must be two names")
    return OdometrySettings(
        *frames,
        values["publish_tf"],
        values["distance_scale"],
        DrivingBoard(values["smallest_radius"], straight_radius=values["straight_radius"]),
        OdometryNoise(**{field.name: values[field.name] for field in fields(OdometryNoise)}),
    )
