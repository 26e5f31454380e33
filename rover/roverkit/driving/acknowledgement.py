"""Numbers of commands, and the stop that is repeated until the driving board has taken it.

The board reports the number of the newest command that it has taken. So a stop that was lost is known to be lost: the
board still reports a command before it. Times are in nanoseconds.
"""

from __future__ import annotations

import secrets
from collections import deque
from dataclasses import replace

from roverkit.driving.board_commands import BoardCommand

_LARGEST = 2**32 - 1
_REPEATED_AFTER_S = 0.1
"""Time that a stop and its report usually need at most."""
_REMEMBERED = 100


class Acknowledgement:
    """Commands of one program. Programs begin with random numbers, so that each knows its own."""

    def __init__(self) -> None:
        self._next = secrets.randbelow(_LARGEST) + 1
        self._moving = deque[int](maxlen=_REMEMBERED)  # numbers of the commands before the stop
        self._stop: BoardCommand | None = None
        self._sent = 0

    def numbered(self, command: BoardCommand, now: int) -> BoardCommand:
        """Return a command that is sent now with its number, which is never 0."""
        command = replace(command, command_number=self._next)
        self._next = self._next % _LARGEST + 1
        self._sent = now
        if command.distance_to_go:
            self._moving.append(command.command_number)
        self._stop = None if command.distance_to_go else command
        return command

    def lost_stop(self, number: int, now: int) -> BoardCommand | None:
        """Take the number in a report of the board; return the stop if it has to be sent again now.

        A board that has taken the command of another program, such as that of a person who drives, gets no stop.
        """
        if self._stop is None or number not in self._moving or now - self._sent < _REPEATED_AFTER_S * 1e9:
            return None
        self._sent = now
        return self._stop
