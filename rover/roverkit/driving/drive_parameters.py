"""Parameters of ``roverlink drive``: limits and times, which ROS 2 can change."""

from __future__ import annotations

import logging
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from roverkit.driving.board_commands import DrivingBoard
from roverkit.driving.drive_control import DriveSettings
from roverkit.driving.drive_declaration import NODE
from roverkit.node.declared_parameters import DeclaredParameters
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.ros_arguments.ros_args import RosArguments

_MAY_BE_ZERO = frozenset({"smallest_radius", "straight_radius", "mode_timeout"})
_PERIODS = 2
"""Commands that must fit into the time for which one is enough, so that a lost one does not stop the rover."""


@dataclass(frozen=True, slots=True)
class DriveProgramSettings:
    """Meaning of the parameters."""

    control: DriveSettings
    base_frame: str


class DriveParameters(DeclaredParameters[DriveProgramSettings]):
    """Parameters of the node."""

    def __init__(self, ros: RosArguments, logger: logging.Logger) -> None:
        """Read the first values. Raises `SetupError` if one of them is not possible."""
        super().__init__(NODE.parameters, {}, ros, _read, logger)


def _read(values: Mapping[str, Any]) -> DriveProgramSettings:
    for parameter in NODE.parameters:
        value = values[parameter.name]
        if parameter.type is float and not (0 < value < math.inf or (value == 0 and parameter.name in _MAY_BE_ZERO)):
            least = "0 or more" if parameter.name in _MAY_BE_ZERO else "above 0"
            raise SetupError(f"the parameter {parameter.name!r} is {value}; it must be {least}")
    if values["horizon"] * values["rate"] < _PERIODS:
        raise SetupError(
            f"the parameter 'horizon' is {values['horizon']} s; it must be at least {_PERIODS} / rate = "
            f"{_PERIODS / values['rate']:g} s, or the rover stops when one command is lost"
        )
    own = dict(values)
    board = DrivingBoard(own.pop("smallest_radius"), own.pop("reverse"), own.pop("straight_radius"))
    limits = {name: own[name] for name in DriveSettings.__dataclass_fields__ if name in own}
    return DriveProgramSettings(DriveSettings(board, period=1 / own["rate"], **limits), own["base_frame"])
