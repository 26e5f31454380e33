"""Exceptions by cause: our own setup, a datagram of a peer, or a value that does not fit."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from enum import Enum

_NAMED = 30  # most names that an error lists


class RoverlinkError(Exception):
    """Base class of all exceptions that this package raises on purpose."""


class RegistryError(RoverlinkError):
    """Generated code, loaded descriptors and table that do not match. Fatal at start."""


class SetupError(RoverlinkError):
    """A bridge that cannot start: a port in use, a name that does not resolve, a wrong parameter."""


class MiddlewareError(RoverlinkError):
    """A ROS 2 middleware that is not installed, or that reports an error."""


class ConversionError(RoverlinkError):
    """A value that does not fit its target type.

    Values are never clamped silently.

    ``field`` is the dotted path of the field in the message; empty if unknown.
    """

    def __init__(self, message: str, field: str = "") -> None:
        super().__init__(f"{field}: {message}" if field else message)
        self.field = field


class Reason(str, Enum):
    """Reason why a datagram was not bridged; counters are kept by reason."""

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
    """A datagram that cannot be bridged because of its content or sender. It is counted, and the bridge goes on."""

    def __init__(self, reason: Reason, message: str, row: str = "") -> None:
        """Name the payload in ``row`` if it is known."""
        super().__init__(message)
        self.reason, self.row = reason, row


def nearest(word: str, known: Iterable[str]) -> str:
    """Return ``did you mean ...?`` with the nearest known word, or else the list of known words."""
    choices = list(known)
    found = difflib.get_close_matches(word, choices, 1)
    if found:
        return f"did you mean {found[0]!r}?"
    more = len(choices) - _NAMED
    return f"known: {', '.join(choices[:_NAMED])}{f' and {more} more' if more > 0 else ''}"
