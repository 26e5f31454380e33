"""Definitions that all CDR codecs use: the encapsulation header, the class `Codec`, and the check of bools."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from roverlink.runtime.core.messages import Message

M = TypeVar("M", bound=Message)

LITTLE_ENDIAN = b"\x00\x01\x00\x00"
"""Encapsulation header of every message that this package writes: PLAIN_CDR, little endian, no options."""

BOOL = "?"
"""Format character of a bool in the module `struct`."""


@dataclass(frozen=True)
class Codec(Generic[M]):
    """CDR encoder and decoder of one message type in one byte order."""

    encode: Callable[[M], bytes]
    decode: Callable[[bytes], M]


def check_flags(values: Iterable[Any]) -> None:
    """Raise `TypeError` if a value of a bool field equals neither True nor False.

    `struct` would accept any object, and write True for every object that Python regards as true.
    """
    for value in values:
        if value not in (True, False):
            raise TypeError("neither True nor False")
