"""Rows of the table whose messages command the driving board, and report what it does."""

from __future__ import annotations

import math

from roverkit.driving.board_commands import BoardCommand
from roverkit.odometry.odometry_declaration import COMMAND, DIAGNOSTICS, PROGRESS, WHEELS
from roverlink.runtime import Registry
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError

_LEFT = PROGRESS.fields[0]


class OdometryRows:
    """Rows `COMMAND`, `PROGRESS` and `DIAGNOSTICS` of a table."""

    def __init__(self, registry: Registry) -> None:
        """Find the rows. Raises `SetupError` if one is missing, or lacks a field."""
        self.command, self.progress = COMMAND.of(registry), PROGRESS.of(registry)
        self.diagnostics = DIAGNOSTICS.of(registry)

    def board_command(self, data: bytes) -> BoardCommand:
        """Return a serialized command. Raises `ConversionError` if it is damaged."""
        message = cdr.decode(self.command.message_type, data)
        return BoardCommand(*(float(getattr(message, name)) for name in COMMAND.fields))

    def distance_left(self, data: bytes) -> float:
        """Return the distance in metres of a serialized report.

        Raises `ConversionError` if it is damaged, or if the distance is no finite number.
        """
        left = float(getattr(cdr.decode(self.progress.message_type, data), _LEFT))
        if not math.isfinite(left):
            raise ConversionError(f"{_LEFT} is {left}")
        return left

    def rpm(self, data: bytes) -> float | None:
        """Return the mean speed of the wheels' motors, each without its sign, in revolutions per minute.

        Without the sign, because motors on the right may turn the other way round. Motors that report an error are left
        out; None if all do. Raises `ConversionError` if the message is damaged.
        """
        message = cdr.decode(self.diagnostics.message_type, data)
        motors = [getattr(message, name) for name in WHEELS]
        speeds = [abs(motor.rpm) for motor in motors if motor.state != motor.ERROR and math.isfinite(motor.rpm)]
        return math.fsum(speeds) / len(speeds) if speeds else None
