"""Rows of the table whose messages command the driving board, and tell who drives."""

from __future__ import annotations

from dataclasses import asdict

from roverkit.driving.board_commands import NUMBER, BoardCommand
from roverkit.driving.drive_declaration import COMMAND, MODE
from roverlink.nodes import Direction, RowTopic, Topic
from roverlink.runtime import Registry
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.messages import fields_of

_AUTOMATIC = "MODE_AUTO"
_REPORT = RowTopic(
    "drive_progress",
    Direction.RECEIVED,
    "number of the newest command that the driving board has taken",
    inbound=True,
    fields=(NUMBER,),
)
"""Topic of a project whose messages have numbers. The declaration of the node has the topics of all projects."""


class DriveRows:
    """Rows `COMMAND` and `MODE` of a table."""

    def __init__(self, registry: Registry) -> None:
        """Find the rows. Raises `SetupError` if one is missing, lacks a field, or lacks the value ``MODE_AUTO``.

        If commands have a number, the reports of the board must have it, too.
        """
        self.command, self.mode = COMMAND.of(registry), MODE.of(registry)
        automatic = getattr(self.mode.message_type, _AUTOMATIC, None)
        if automatic is None:
            raise SetupError(
                f"{self.mode.message_type.__msgtype__}, the message of row {MODE.row!r}, has no value {_AUTOMATIC}; "
                "add it"
            )
        self._automatic = automatic
        self.report: Topic | None = None
        """Topic on which the board reports the number of the newest command; None if the project has no numbers."""
        if NUMBER in {field.name for field in fields_of(self.command.message_type)}:
            self.report = _REPORT.of(registry)

    def values(self, command: BoardCommand) -> dict[str, float]:
        """Return the fields of a command that its message has."""
        values = asdict(command)
        return {name: values[name] for name in COMMAND.fields} if self.report is None else values

    def serialized(self, command: BoardCommand) -> bytes:
        """Return the serialized message of a command."""
        return cdr.encode(self.command.message_type(**self.values(command)))

    def number(self, data: bytes) -> int:
        """Return the number in a serialized report. Raises `ConversionError` if the message is damaged."""
        assert self.report is not None  # noqa: S101  # or no report is received
        return int(getattr(cdr.decode(self.report.message_type, data), NUMBER))

    def is_automatic(self, data: bytes) -> bool:
        """Return true if a serialized mode says that the rover drives by itself.

        Raises `ConversionError` if the message is damaged. Every value but ``MODE_AUTO`` is manual.
        """
        return bool(getattr(cdr.decode(self.mode.message_type, data), MODE.fields[0]) == self._automatic)
