"""What the codecs share: the encapsulation header, the pair of functions, and what a bool may be."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from roverlink.runtime.core.messages import Message

M = TypeVar("M", bound=Message)

LITTLE_ENDIAN = b"\x00\x01\x00\x00"
"""The encapsulation header of what we write: PLAIN_CDR, little endian, no options."""

BOOL = "?"
"""The `struct` format of a bool."""


@dataclass(frozen=True)
class Codec(Generic[M]):
    """The two directions of one message type in one byte order."""

    encode: Callable[[M], bytes]
    decode: Callable[[bytes], M]


def check_flags(values: Iterable[Any]) -> None:
    """Refuse what `struct` would take for a bool: it asks any object whether it is true."""
    for value in values:
        if value not in (True, False):
            raise TypeError("neither true nor false")
