"""H.264 (ITU-T H.264): NAL units of a byte stream, and the time of an image in an SEI message.

An access unit is one encoded image: the NAL units of its slices, after parameter sets and other information.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Sequence
from enum import IntEnum
from uuid import UUID

_START = re.compile(rb"\x00\x00\x01")
START_CODE = b"\x00\x00\x00\x01"
"""Bytes before each NAL unit of a byte stream (Annex B)."""
_STAMPS = UUID("0b0d5a0c-7f6e-4d7a-9a55-6a2f6f3c7e11").bytes
"""Identifier of our SEI messages: a random UUID, as clause D.2.7 has it (user_data_unregistered)."""
_STAMP = struct.Struct(">Q")
_USER_DATA = 5  # payloadType
_END = b"\x80"  # rbsp_trailing_bits


class NalType(IntEnum):
    """Type of a NAL unit (table 7-1)."""

    SLICE = 1
    KEY_SLICE = 5
    SEI = 6
    SPS = 7
    PPS = 8
    DELIMITER = 9


def nal_type(nal: bytes) -> int:
    """Return the type of a NAL unit, which is not always a `NalType`."""
    return nal[0] & 0x1F if nal else 0


def nal_units(stream: bytes) -> list[bytes]:
    """Split a byte stream (Annex B) into its NAL units, without start codes."""
    marks = [match.span() for match in _START.finditer(stream)]
    ends = [begin for begin, _ in marks[1:]] + [len(stream)]
    # Zeros before a start code belong to it, or are padding; a NAL unit never ends with one (clause 7.4.1).
    units = (stream[start:end].rstrip(b"\x00") for (_, start), end in zip(marks, ends))
    return [unit for unit in units if unit]


def byte_stream(nals: Sequence[bytes]) -> bytes:
    """Return the byte stream of NAL units."""
    return b"".join(START_CODE + nal for nal in nals)


def is_key_frame(nals: Sequence[bytes]) -> bool:
    """Return true if an access unit can be decoded without others before it (IDR picture)."""
    return any(nal_type(nal) == NalType.KEY_SLICE for nal in nals)


def with_stamp(nals: Sequence[bytes], stamp: int) -> list[bytes]:
    """Return an access unit with the time of its image in nanoseconds since 1970, as an SEI message before the slices.

    Decoders that do not know the message ignore it.
    """
    content = _STAMPS + _STAMP.pack(stamp)
    message = _protected(bytes([NalType.SEI, _USER_DATA, len(content)]) + content + _END)
    first = next((index for index, nal in enumerate(nals) if nal_type(nal) <= NalType.KEY_SLICE), len(nals))
    return [*nals[:first], message, *nals[first:]]


def stamp_of(nals: Sequence[bytes]) -> int | None:
    """Return the time of an access unit's image in nanoseconds since 1970; None if our sender did not write it."""
    for nal in nals:
        if nal_type(nal) == NalType.SEI:
            content = nal.replace(b"\x00\x00\x03", b"\x00\x00")
            if content[1:2] == bytes([_USER_DATA]) and content[3:19] == _STAMPS and len(content) >= 27:
                return int(_STAMP.unpack_from(content, 19)[0])
    return None


def _protected(nal: bytes) -> bytes:
    """Return a NAL unit with emulation prevention bytes, so that nothing in it looks like a start code (7.4.1)."""
    return re.sub(rb"\x00\x00(?=[\x00-\x03])", b"\x00\x00\x03", nal)
