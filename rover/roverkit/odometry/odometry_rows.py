"""Rows of the table whose messages command the driving board, and report what it does."""

from __future__ import annotations

import math
from dataclasses import fields

from roverkit.driving.board_commands import BoardCommand
from roverlink.runtime import Registry
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError

COMMAND, PROGRESS, DIAGNOSTICS = "drive_motor", "drive_progress", "drive_diag"
"""Names of the rows in mapping.yaml."""
_COMMAND = tuple(field.name for field in fields(BoardCommand))
_LEFT = "distance_left"
WHEELS = tuple(f"{place}_{side}_motor" for side in ("left", "right") for place in ("front", "middle", "back"))
"""Fields of the diagnostics: the motors of the wheels."""


class OdometryRows:
    """Rows `COMMAND`, `PROGRESS` and `DIAGNOSTICS` of a table."""

    def __init__(self, registry: Registry) -> None:
        """Find the rows. Raises `SetupError` if one is missing, or lacks a field."""
        self.command = registry.row(COMMAND, _COMMAND, inbound=False)
        self.progress = registry.row(PROGRESS, (_LEFT,), inbound=True)
        self.diagnostics = registry.row(DIAGNOSTICS, WHEELS, inbound=True)

    def board_command(self, data: bytes) -> BoardCommand:
        """Return a serialized command. Raises `ConversionError` if it is damaged."""
        message = cdr.decode(self.command.message_type, data)
        return BoardCommand(*(float(getattr(message, name)) for name in _COMMAND))

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
