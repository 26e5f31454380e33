"""Exceptions of this package, grouped by cause: our own setup, a datagram of a peer, or a value that does not fit."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from enum import Enum

_NAMED = 30  # most names that an error lists


class RoverlinkError(Exception):
    """Base class of all exceptions that this package raises on purpose."""


class RegistryError(RoverlinkError):
    """Mismatch between the generated code, the loaded descriptors and the table. The program cannot start."""


class SetupError(RoverlinkError):
    """Problem that the user has to solve before the program can work, such as a port in use or a missing file."""


class MiddlewareError(RoverlinkError):
    """Error of a ROS 2 middleware, or a middleware that is not installed."""


class ConversionError(RoverlinkError):
    """Value that does not fit the type to which it is converted.

    Such a value is never changed silently to the nearest value that fits. ``field`` is the dotted path of the field in
    the message; it is empty if the field is unknown.
    """

    def __init__(self, message: str, field: str = "") -> None:
        super().__init__(f"{field}: {message}" if field else message)
        self.field = field


class Reason(str, Enum):
    """Reason why a datagram was not bridged. Dropped datagrams are counted by reason."""

    EMPTY = "empty"
    OVERSIZED = "oversized"
    MALFORMED = "malformed"
    UNKNOWN_PAYLOAD = "unknown_payload"
    WRONG_DIRECTION = "wrong_direction"
    CONVERSION = "conversion"
    NOT_PUBLISHED = "not_published"
    SUPERSEDED = "superseded"
    UNKNOWN_SOURCE = "unknown_source"
    WRONG_SOURCE = "wrong_source"
    OVER_RATE = "over_rate"
    STOPPED = "stopped"


class DatagramError(RoverlinkError):
    """Error of one datagram: its content or its sender does not allow to bridge it.

    The datagram is counted as dropped.
    """

    def __init__(self, reason: Reason, message: str, row: str = "") -> None:
        """Create the error; ``row`` is the name of the payload, or empty if it is unknown."""
        super().__init__(message)
        self.reason, self.row = reason, row


def nearest(word: str, known: Iterable[str]) -> str:
    """Return ``did you mean ...?`` with the most similar known word. If none is similar, return all known words."""
    choices = list(known)
    found = difflib.get_close_matches(word, choices, 1)
    if found:
        return f"did you mean {found[0]!r}?"
    more = len(choices) - _NAMED
    return f"known: {', '.join(choices[:_NAMED])}{f' and {more} more' if more > 0 else ''}"
