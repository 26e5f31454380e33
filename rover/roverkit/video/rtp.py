"""RTP packets (RFC 3550), and H.264 in them (RFC 6184, packetization mode 1)."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from roverkit.video.h264 import nal_type

CLOCK_HZ = 90_000
"""Clock rate of the timestamps of video."""
PAYLOAD_TYPE = 96
"""Payload type of the sent packets: the first dynamic one, which the basestation's pipelines expect."""
_HEADER = struct.Struct(">BBHII")
_VERSION = 0x80
_STAP_A, _FU_A = 24, 28
_FU_HEADER = 2
_LENGTH = struct.Struct(">H")


class RtpPacket(NamedTuple):
    """RTP packet."""

    sequence: int
    """Number of the packet, 16 bits."""
    timestamp: int
    """Time of the image in units of 1/90000 s from a random start, 32 bits."""
    ssrc: int
    """Random number of the sender's run, 32 bits."""
    marker: bool
    """True for the last packet of an access unit."""
    payload: bytes
    payload_type: int = PAYLOAD_TYPE

    def encode(self) -> bytes:
        """Return the bytes of the packet."""
        second = self.marker << 7 | self.payload_type
        return _HEADER.pack(_VERSION, second, self.sequence, self.timestamp, self.ssrc) + self.payload


def read_packet(data: bytes) -> RtpPacket | None:
    """Parse an RTP packet. Return None if the bytes are no RTP packet, or have no payload."""
    if len(data) < _HEADER.size or data[0] >> 6 != 2:
        return None
    first, second, sequence, timestamp, ssrc = _HEADER.unpack_from(data)
    start, end = _HEADER.size + 4 * (first & 0x0F), len(data)
    if first & 0x10:  # header extension
        if len(data) < start + 4:
            return None
        start += 4 + 4 * int(_LENGTH.unpack_from(data, start + 2)[0])
    if first & 0x20:  # padding, whose length is in the last byte
        end -= data[-1]
    if start >= end:
        return None
    return RtpPacket(sequence, timestamp, ssrc, bool(second >> 7), data[start:end], second & 0x7F)


def payloads(nals: Sequence[bytes], largest: int) -> list[bytes]:
    """Return the payloads of the RTP packets of an access unit; none of them is longer than `largest` bytes.

    Small NAL units, such as parameter sets, go together into one packet (STAP-A); those that are too long are
    divided (FU-A).
    """
    found: list[bytes] = []
    group: list[bytes] = []

    def close() -> None:
        if len(group) == 1:
            found.extend(group)
        elif group:
            importance = max(nal[0] & 0x60 for nal in group)  # nal_ref_idc of the packet: the largest of them
            body = b"".join(_LENGTH.pack(len(nal)) + nal for nal in group)
            found.append(bytes([importance | _STAP_A]) + body)
        group.clear()

    for nal in nals:
        if 1 + sum(2 + len(unit) for unit in (*group, nal)) > largest:
            close()
        if len(nal) > largest:
            found.extend(_fragments(nal, largest))
        else:
            group.append(nal)
    close()
    return found


def _fragments(nal: bytes, largest: int) -> Iterator[bytes]:
    room = largest - _FU_HEADER
    indicator, kind = nal[0] & 0xE0 | _FU_A, nal[0] & 0x1F
    for start in range(1, len(nal), room):
        begins, ends = start == 1, start + room >= len(nal)
        yield bytes([indicator, begins << 7 | ends << 6 | kind]) + nal[start : start + room]


class AccessUnit(NamedTuple):
    """Encoded image that was received."""

    nals: list[bytes]
    timestamp: int
    complete: bool
    """False if packets of it are missing."""


class Depacketizer:
    """Puts the payloads of RTP packets together to access units. The packets come in their order, with gaps."""

    def __init__(self) -> None:
        self._nals: list[bytes] = []
        self._fragments: list[bytes] = []
        self._timestamp: int | None = None
        self._complete = True

    def add(self, packet: RtpPacket, lost: int) -> Iterator[AccessUnit]:
        """Take the next packet, before which `lost` packets are missing, and yield the access units that end.

        A unit ends with a packet whose marker is set; if that one is missing, it ends before a packet of another time.
        """
        changed = self._timestamp not in (None, packet.timestamp)
        if lost:
            # The missing packets are of the unit before, of this one, or of both.
            self._lose()
        if changed:
            yield from self._end()
        if self._timestamp is None:
            self._timestamp, self._complete = packet.timestamp, not lost
        self._take(packet.payload)
        if packet.marker:
            yield from self._end()

    def _end(self) -> Iterator[AccessUnit]:
        if self._fragments:
            self._lose()
        if self._nals and self._timestamp is not None:
            yield AccessUnit(self._nals, self._timestamp, self._complete)
        self._nals, self._timestamp, self._complete = [], None, True

    def _lose(self) -> None:
        self._fragments, self._complete = [], False

    def _take(self, payload: bytes) -> None:
        kind = nal_type(payload)
        if kind == _FU_A:
            self._take_fragment(payload)
        elif kind == _STAP_A:
            self._take_group(payload)
        elif 0 < kind < _STAP_A:
            self._nals.append(payload)
        else:
            self._lose()  # of packetization mode 2, or reserved

    def _take_group(self, payload: bytes) -> None:
        start = 1
        while start + 2 < len(payload):
            (length,) = _LENGTH.unpack_from(payload, start)
            nal = payload[start + 2 : start + 2 + length]
            if len(nal) < length or not nal:
                self._lose()
                return
            self._nals.append(nal)
            start += 2 + length

    def _take_fragment(self, payload: bytes) -> None:
        if len(payload) <= _FU_HEADER:
            self._lose()
            return
        begins, ends, kind = payload[1] & 0x80, payload[1] & 0x40, payload[1] & 0x1F
        if begins:
            if self._fragments:
                self._lose()
            self._fragments = [bytes([payload[0] & 0xE0 | kind]), payload[_FU_HEADER:]]
        elif self._fragments:
            self._fragments.append(payload[_FU_HEADER:])
        else:
            self._complete = False  # its begin was lost
        if ends and self._fragments:
            self._nals.append(b"".join(self._fragments))
            self._fragments = []
