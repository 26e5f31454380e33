"""Frames that carry datagrams over a stream of bytes: on a serial line, and on TCP.

A frame on a serial line is the datagram, then its CRC-16 in two bytes (the higher one first), all encoded with COBS
(Cheshire and Baker, 1999), then a zero byte. The CRC is CRC-16/CCITT-FALSE: polynomial 0x1021, initial value 0xFFFF,
nothing reflected; that of the text ``123456789`` is 0x29B1. COBS leaves no zero byte in a frame. So a receiver that has
lost its place, through noise or because it was switched on late, has it again after the next zero byte. Empty frames
mean nothing: a sender may send zero bytes at any time, and begins with one.

A datagram on TCP follows its length as a varint, as ``writeDelimitedTo`` and ``parseDelimitedFrom`` of protobuf do.
"""

from __future__ import annotations

from binascii import crc_hqx

_CRC_START = 0xFFFF
_CRC_SIZE = 2
_LENGTH_SIZE = 5  # bytes of the longest varint that protobuf takes as a length
_RUN = 254  # most bytes without a zero that follow one code byte (COBS)

END = b"\0"
"""Byte that ends a frame."""


def encode_frame(datagram: bytes) -> bytes:
    """Return the frame of a datagram, with the zero byte that ends it."""
    framed = bytearray()
    runs = (datagram + crc_hqx(datagram, _CRC_START).to_bytes(_CRC_SIZE, "big")).split(END)
    last = len(runs[-1])
    for run in runs:
        while len(run) >= _RUN:
            framed.append(_RUN + 1)
            framed += run[:_RUN]
            run = run[_RUN:]
        framed.append(len(run) + 1)
        framed += run
    if last and last % _RUN == 0:
        del framed[-1]  # the code of the zero byte that would follow
    return bytes(framed + END)


def decode_frame(frame: bytes) -> bytes | None:
    """Return the datagram of a frame without its last zero byte; None if the frame was damaged."""
    decoded, at = bytearray(), 0
    while at < len(frame):
        code = frame[at]
        decoded += frame[at + 1 : at + code]
        at += code
        if code <= _RUN and at < len(frame):
            decoded.append(0)
    datagram, crc = bytes(decoded[:-_CRC_SIZE]), bytes(decoded[-_CRC_SIZE:])
    is_whole = at == len(frame) and len(crc) == _CRC_SIZE
    return datagram if is_whole and crc_hqx(datagram, _CRC_START) == int.from_bytes(crc, "big") else None


def largest_frame(datagram: int) -> int:
    """Return the most bytes that a frame without its last zero byte can have, for the size of a datagram."""
    size = datagram + _CRC_SIZE
    return size + size // _RUN + 1


class FrameReader:
    """Reader of frames from the bytes of a serial line. Its memory is bounded, whatever arrives."""

    def __init__(self, largest: int) -> None:
        """Read datagrams of at most ``largest`` bytes."""
        self._longest = largest_frame(largest)
        self._rest = b""
        self._skipping = False
        self.refused = 0
        """Frames that were damaged or too long."""

    def take(self, received: bytes) -> list[bytes]:
        """Return the datagrams whose frames end in ``received``, the next bytes of the line."""
        *frames, self._rest = (self._rest + received).split(END)
        if frames and self._skipping:
            self._skipping = False
            del frames[0]  # the end of a frame that is counted already
        datagrams = []
        for frame in filter(None, frames):
            datagram = decode_frame(frame) if len(frame) <= self._longest else None
            if datagram is None:
                self.refused += 1
            else:
                datagrams.append(datagram)
        if len(self._rest) > self._longest:
            self.refused += not self._skipping
            self._skipping, self._rest = True, b""
        return datagrams


def delimited(datagram: bytes) -> bytes:
    """Return a datagram behind its length."""
    size, prefix = len(datagram), bytearray()
    while size > 0x7F:
        prefix.append(size & 0x7F | 0x80)
        size >>= 7
    prefix.append(size)
    return bytes(prefix) + datagram


class DelimitedReader:
    """Reader of datagrams behind their lengths from the bytes of a connection."""

    def __init__(self, largest: int) -> None:
        """Read datagrams of at most ``largest`` bytes."""
        self._largest = largest
        self._rest = bytearray()

    def take(self, received: bytes) -> list[bytes]:
        """Return the datagrams that end in ``received``, the next bytes of the connection.

        Raises `ValueError` for a length that no datagram has: what follows cannot be read, either.
        """
        self._rest += received
        datagrams, start = [], 0
        while (head := self._length_at(start)) is not None:
            length, first = head
            if first + length > len(self._rest):
                break
            datagrams.append(bytes(self._rest[first : first + length]))
            start = first + length
        del self._rest[:start]
        return datagrams

    def _length_at(self, start: int) -> tuple[int, int] | None:
        """Return the length of the datagram at a place, and where it begins; None if the length is not complete."""
        length = 0
        for index, byte in enumerate(self._rest[start : start + _LENGTH_SIZE], 1):
            length |= (byte & 0x7F) << 7 * (index - 1)
            if length > self._largest or (index == _LENGTH_SIZE and byte > 0x7F):
                raise ValueError("the other side does not send datagrams behind their lengths")
            if byte <= 0x7F:
                return length, start + index
        return None
