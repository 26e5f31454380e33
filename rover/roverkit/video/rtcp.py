"""RTCP packets (RFC 3550, RFC 4585) with which a receiver of video and its sender tell each other what arrives.

They travel on the port of the RTP packets (RFC 5761), because the ports of the streams are consecutive.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from typing import NamedTuple

_SENDER_REPORT, _RECEIVER_REPORT, _SDES, _FEEDBACK, _PAYLOAD_FEEDBACK = 200, 201, 202, 205, 206
_NACK, _PLI = 1, 1  # formats of the two kinds of feedback
_CNAME = 1
_HEADER = struct.Struct(">BBH")
_SENDER = struct.Struct(">IQIII")
_BLOCK = struct.Struct(">IIIIII")
_NACK_ITEM = struct.Struct(">HH")
_WORD = struct.Struct(">I")
_1970 = 2_208_988_800  # seconds from 1900, the start of NTP's time
_LARGEST_LOST = 2**23 - 1


class SenderReport(NamedTuple):
    """Report of a sender: which of its timestamps belongs to which time."""

    ssrc: int
    ntp: int
    """Time of the report as NTP has it: seconds since 1900 in units of 2**-32."""
    timestamp: int
    packets: int
    octets: int

    def encode(self) -> bytes:
        """Return the bytes of the report, with the source description that RFC 3550 demands."""
        return _packed(_SENDER_REPORT, 0, _SENDER.pack(*self)) + _description(self.ssrc)


class ReceiverReport(NamedTuple):
    """Report of a receiver about a stream."""

    ssrc: int
    """Number of the receiver."""
    source: int
    """Number of the stream's sender."""
    fraction_lost: float
    """Part of the packets since the last report that were lost, from 0 to 1."""
    lost: int
    """Packets that were lost since the begin."""
    highest: int
    """Largest sequence number, extended to 32 bits."""
    jitter: int
    """Jitter of the arrival in units of the timestamps."""
    last_report: int
    """Middle 32 bits of `SenderReport.ntp`; 0 if none was received."""
    delay: int
    """Time since that report in units of 2**-16 s."""

    def encode(self) -> bytes:
        """Return the bytes of the report, with the source description that RFC 3550 demands."""
        fraction = min(int(self.fraction_lost * 256), 255) << 24
        lost = min(max(self.lost, -_LARGEST_LOST), _LARGEST_LOST) & 0xFFFFFF
        block = _BLOCK.pack(self.source, fraction | lost, self.highest, self.jitter, self.last_report, self.delay)
        return _packed(_RECEIVER_REPORT, 1, _WORD.pack(self.ssrc) + block) + _description(self.ssrc)


class PictureLoss(NamedTuple):
    """Request of a receiver for a key frame (PLI, RFC 4585)."""

    ssrc: int
    source: int

    def encode(self) -> bytes:
        """Return the bytes of the request."""
        return _packed(_PAYLOAD_FEEDBACK, _PLI, _WORD.pack(self.ssrc) + _WORD.pack(self.source))


class Missing(NamedTuple):
    """Request of a receiver to send packets again (generic NACK, RFC 4585)."""

    ssrc: int
    source: int
    sequences: tuple[int, ...]
    """Sequence numbers of the packets, in the order of the stream."""

    def encode(self) -> bytes:
        """Return the bytes of the request."""
        items: list[tuple[int, int]] = []
        for sequence in self.sequences:
            behind = (sequence - items[-1][0]) & 0xFFFF if items else 0
            if 1 <= behind <= 16:
                items[-1] = items[-1][0], items[-1][1] | 1 << (behind - 1)
            else:
                items.append((sequence, 0))
        body = b"".join(_NACK_ITEM.pack(*item) for item in items)
        return _packed(_FEEDBACK, _NACK, _WORD.pack(self.ssrc) + _WORD.pack(self.source) + body)


Report = SenderReport | ReceiverReport | PictureLoss | Missing


def is_rtcp(data: bytes) -> bool:
    """Return true if a datagram is RTCP, and not RTP (RFC 5761)."""
    return len(data) >= 8 and data[0] >> 6 == 2 and 192 <= data[1] <= 223


def read_reports(data: bytes) -> Iterator[Report]:
    """Yield the known reports in a datagram; what is damaged or unknown is left out."""
    start = 0
    while start + _HEADER.size <= len(data):
        first, kind, words = _HEADER.unpack_from(data, start)
        end = start + 4 + 4 * words
        if first >> 6 != 2 or end > len(data):
            return
        yield from _read(kind, first & 0x1F, data[start + 4 : end])
        start = end


def ntp_of(stamp: int) -> int:
    """Return a time in nanoseconds since 1970 as NTP has it, which begins at 0 again in 2036."""
    seconds, rest = divmod(stamp, 10**9)
    return (seconds + _1970 & 0xFFFFFFFF) << 32 | (rest << 32) // 10**9


def middle_of(ntp: int) -> int:
    """Return the middle 32 bits of a time of NTP, in units of 2**-16 s."""
    return ntp >> 16 & 0xFFFFFFFF


def _read(kind: int, count: int, body: bytes) -> Iterator[Report]:
    if kind == _SENDER_REPORT and len(body) >= _SENDER.size:
        yield SenderReport(*_SENDER.unpack_from(body))
    elif kind == _RECEIVER_REPORT and len(body) >= 4 + count * _BLOCK.size:
        for index in range(count):
            source, losses, *rest = _BLOCK.unpack_from(body, 4 + index * _BLOCK.size)
            lost = losses & 0xFFFFFF
            signed = lost - (1 << 24) if lost > _LARGEST_LOST else lost
            yield ReceiverReport(_word(body, 0), source, (losses >> 24) / 256, signed, *rest)
    elif kind == _PAYLOAD_FEEDBACK and count == _PLI and len(body) >= 8:
        yield PictureLoss(_word(body, 0), _word(body, 4))
    elif kind == _FEEDBACK and count == _NACK and len(body) >= 8:
        yield Missing(_word(body, 0), _word(body, 4), tuple(_missing(body[8:])))


def _missing(body: bytes) -> Iterator[int]:
    for first, others in _NACK_ITEM.iter_unpack(body[: len(body) // 4 * 4]):
        yield first
        for bit in range(16):
            if others >> bit & 1:
                yield (first + bit + 1) & 0xFFFF


def _word(body: bytes, start: int) -> int:
    return int(_WORD.unpack_from(body, start)[0])


def _description(ssrc: int) -> bytes:
    """Return a source description whose canonical name is the number of the source: it names no computer."""
    name = f"{ssrc:08x}".encode()
    item = _WORD.pack(ssrc) + bytes([_CNAME, len(name)]) + name
    return _packed(_SDES, 1, item + b"\0" * (4 - len(item) % 4))


def _packed(kind: int, count: int, body: Sequence[int] | bytes) -> bytes:
    return _HEADER.pack(0x80 | count, kind, len(body) // 4) + bytes(body)
