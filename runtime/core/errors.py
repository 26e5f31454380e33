"""Errors, typed by whose fault they are: ours at start, the peer's at run time, or a value's."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from enum import Enum

_NAMED = 30  # choices that an error lists


class RoverlinkError(Exception):
    """Base of every error that this package raises on purpose."""


class RegistryError(RoverlinkError):
    """The generated code, the loaded descriptors and the table do not belong together. Fatal at start."""


class SetupError(RoverlinkError):
    """The bridge cannot start: a port in use, a name that does not resolve, a wrong parameter."""


class MiddlewareError(RoverlinkError):
    """A ROS 2 middleware that was asked for is not there, or refuses what is asked of it."""


class ConversionError(RoverlinkError):
    """A value does not fit the type it is converted to. Nothing is ever clamped in silence.

    ``field`` is the dotted path of the field in the message, empty where it is not known.
    """

    def __init__(self, message: str, field: str = "") -> None:
        super().__init__(f"{field}: {message}" if field else message)
        self.field = field


class Reason(str, Enum):
    """Why a datagram was not bridged; the counters are kept by these."""

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
    """A datagram that cannot be bridged: the peer's fault. It is counted by reason and the loop goes on."""

    def __init__(self, reason: Reason, message: str, row: str = "") -> None:
        """``row`` is the name of the payload, where it is known."""
        super().__init__(message)
        self.reason, self.row = reason, row


def nearest(word: str, known: Iterable[str]) -> str:
    """``did you mean ...?`` with the known word nearest to one that is not; else all that are known."""
    choices = list(known)
    found = difflib.get_close_matches(word, choices, 1)
    if found:
        return f"did you mean {found[0]}?"
    more = len(choices) - _NAMED
    return f"there are {', '.join(choices[:_NAMED])}{f' and {more} more' if more > 0 else ''}"
