"""Rows of the table whose messages command the driving board, and tell who drives."""

from __future__ import annotations

from dataclasses import asdict

from roverkit.driving.board_commands import BoardCommand
from roverkit.driving.drive_declaration import COMMAND, MODE
from roverlink.runtime import Registry
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import SetupError

_AUTOMATIC = "MODE_AUTO"


class DriveRows:
    """Rows `COMMAND` and `MODE` of a table."""

    def __init__(self, registry: Registry) -> None:
        """Find the rows. Raises `SetupError` if one is missing, lacks a field, or lacks the value ``MODE_AUTO``."""
        self.command, self.mode = COMMAND.of(registry), MODE.of(registry)
        automatic = getattr(self.mode.message_type, _AUTOMATIC, None)
        if automatic is None:
            raise SetupError(
                f"{self.mode.message_type.__msgtype__}, the message of row {MODE.row!r}, has no value {_AUTOMATIC}; "
                "add it"
            )
        self._automatic = automatic

    def serialized(self, command: BoardCommand) -> bytes:
        """Return the serialized message of a command."""
        return cdr.encode(self.command.message_type(**asdict(command)))

    def is_automatic(self, data: bytes) -> bool:
        """Return true if a serialized mode says that the rover drives by itself.

        Raises `ConversionError` if the message is damaged. Every value but ``MODE_AUTO`` is manual.
        """
        return bool(getattr(cdr.decode(self.mode.message_type, data), MODE.fields[0]) == self._automatic)
