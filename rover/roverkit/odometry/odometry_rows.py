"""Rows of the table whose messages command the driving board, and report what it does."""

from __future__ import annotations

import math
from typing import NamedTuple

from roverkit.driving.arcs import FARTHEST_M
from roverkit.driving.board_commands import NUMBER, BoardCommand
from roverkit.odometry.odometry_declaration import COMMAND, DIAGNOSTICS, ODOMETER, PROGRESS, WHEELS
from roverlink.nodes import Topic
from roverlink.runtime import Registry
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.core.messages import fields_of

_LEFT = PROGRESS.fields[0]
_FASTEST_RPM = 1e6
"""Speed that no motor reaches, also in units of another scale."""


class BoardReport(NamedTuple):
    """Report of the driving board."""

    distance_left: float
    """Distance in metres that is left on the current command."""
    odometer: float | None
    """Signed distance in metres since the start of the board; None if the project does not have it."""
    command_number: int | None
    """Number of the newest command that the board has taken; None if the project does not have it."""


class OdometryRows:
    """Rows `COMMAND`, `PROGRESS` and `DIAGNOSTICS` of a table."""

    def __init__(self, registry: Registry) -> None:
        """Find the rows. Raises `SetupError` if one is missing, or lacks a field."""
        self.command, self.progress = COMMAND.of(registry), PROGRESS.of(registry)
        self.diagnostics = DIAGNOSTICS.of(registry)

        self.has_odometer = ODOMETER in self._names(self.progress)
        """True if the board reports its odometer."""

    @staticmethod
    def _names(topic: Topic) -> set[str]:
        return {field.name for field in fields_of(topic.message_type)}

    def board_command(self, data: bytes) -> BoardCommand:
        """Return a serialized command. Raises `ConversionError` if it is damaged."""
        message = cdr.decode(self.command.message_type, data)
        distance, radius = (float(getattr(message, name)) for name in COMMAND.fields)
        return BoardCommand(distance, radius, getattr(message, NUMBER, 0))

    def report(self, data: bytes) -> BoardReport:
        """Return a serialized report.

        Raises `ConversionError` if it is damaged, or if a distance is no number, or none on Earth.
        """
        message = cdr.decode(self.progress.message_type, data)
        odometer = getattr(message, ODOMETER, None)
        for name, value in ((_LEFT, getattr(message, _LEFT)), (ODOMETER, odometer or 0.0)):
            if not abs(value) <= FARTHEST_M:
                raise ConversionError(f"{name} is {value}")
        return BoardReport(getattr(message, _LEFT), odometer, getattr(message, NUMBER, None))

    def rpm(self, data: bytes) -> float | None:
        """Return the mean speed of the wheels' motors, each without its sign, in revolutions per minute.

        Without the sign, because motors on the right may turn the other way round. Motors that report an error are left
        out, and speeds of no motor; None if all are. Raises `ConversionError` if the message is damaged.
        """
        message = cdr.decode(self.diagnostics.message_type, data)
        motors = [getattr(message, name) for name in WHEELS]
        speeds = [abs(motor.rpm) for motor in motors if motor.state != motor.ERROR and abs(motor.rpm) < _FASTEST_RPM]
        return math.fsum(speeds) / len(speeds) if speeds else None
