"""Order of received RTP packets: late packets get their place, missing ones are requested, and losses are counted."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from roverkit.video.rtp import CLOCK_HZ, RtpPacket

WAIT_NS = 50_000_000
"""Longest time for which a missing packet is waited for, in nanoseconds: that of the basestation's pipelines."""
_AGAIN_NS = 15_000_000
"""Time after which a missing packet is requested again; most radio links answer faster."""
_MOST_REQUESTED = 64  # packets; what misses more needs a key frame
_JUMP = 3000  # MAX_DROPOUT of RFC 3550, A.1: a larger step is a restart
_SEQUENCES = 1 << 16


@dataclass(slots=True)
class Arrivals:
    """Counts of the packets of a stream."""

    received: int = 0
    """Packets that arrived in time, without repetitions."""
    lost: int = 0
    """Packets that never arrived, or too late."""
    repaired: int = 0
    """Packets that arrived after they had been requested."""
    highest: int = 0
    """Largest sequence number, extended beyond 16 bits."""
    jitter: float = 0.0
    """Jitter of the arrival in units of the timestamps (RFC 3550, A.8)."""


@dataclass(slots=True)
class _Gap:
    """Missing packet."""

    since: int
    asked_at: int | None = None
    """Time of the last request; None if there was none."""


class Reordering:
    """Packets of one stream in their order. Times are in nanoseconds of a clock that never jumps.

    A packet leaves at once if all before it have left. Packets after a missing one wait for it, at most `WAIT_NS`.
    """

    def __init__(self) -> None:
        self.ssrc: int | None = None
        """Number of the sender's run; None before the first packet."""
        self.arrivals = Arrivals()
        self._next = 0
        self._waiting: dict[int, RtpPacket] = {}
        self._gaps: dict[int, _Gap] = {}
        self._transit: float | None = None

    def begins(self, packet: RtpPacket) -> bool:
        """Return true if counting starts again with a packet: it is of another run, or far from the newest one."""
        return packet.ssrc != self.ssrc or abs(self._nearest(packet) - self.arrivals.highest) > _JUMP

    def add(self, packet: RtpPacket, now: int) -> Iterator[tuple[RtpPacket, int]]:
        """Take a packet that has arrived; yield the packets whose turn it is, each with the number lost before it."""
        number = self._extended(packet)
        if number is None:
            return
        if number in self._gaps:
            self.arrivals.repaired += self._gaps.pop(number).asked_at is not None
        for missing in range(max(self.arrivals.highest + 1, self._next), number):
            self._gaps[missing] = _Gap(now)
        self.arrivals.highest = max(self.arrivals.highest, number)
        self.arrivals.received += 1
        self._measure_jitter(packet, now)
        self._waiting[number] = packet
        yield from self.due(now)

    def due(self, now: int) -> Iterator[tuple[RtpPacket, int]]:
        """Yield the packets whose turn it is at a time, each with the number of packets lost before it."""
        while self._waiting:
            lost = 0
            if self._next not in self._waiting:
                first = min(self._waiting)
                if any(now - self._gaps[gap].since < WAIT_NS for gap in range(self._next, first) if gap in self._gaps):
                    return
                lost = first - self._next
                self.arrivals.lost += lost
                for gap in range(self._next, first):
                    self._gaps.pop(gap, None)
                self._next = first
            packet = self._waiting.pop(self._next)
            self._next += 1
            yield packet, lost

    def wanted(self, now: int) -> list[int]:
        """Return the sequence numbers that should be requested from the sender now."""
        wanted = [number for number, gap in self._gaps.items() if self._next_request(gap) <= now]
        for number in wanted:
            self._gaps[number].asked_at = now
        return [number % _SEQUENCES for number in wanted]

    def next_due(self) -> float | None:
        """Return the time at which `due` or `wanted` should be called again; None if nothing is missing."""
        return min((min(gap.since + WAIT_NS, self._next_request(gap)) for gap in self._gaps.values()), default=None)

    def _next_request(self, gap: _Gap) -> float:
        """Return the time at which a missing packet should be requested."""
        if len(self._gaps) > _MOST_REQUESTED:
            return math.inf
        return gap.since if gap.asked_at is None else gap.asked_at + _AGAIN_NS

    def _extended(self, packet: RtpPacket) -> int | None:
        """Return the packet's number beyond 16 bits; None for a repetition, or if it is too late."""
        if self.begins(packet):
            return self._restart(packet)
        number = self._nearest(packet)
        return None if number < self._next or number in self._waiting else number

    def _nearest(self, packet: RtpPacket) -> int:
        """Return the packet's number beyond 16 bits that is nearest to the newest one."""
        last = self.arrivals.highest
        return last + (packet.sequence - last + _SEQUENCES // 2) % _SEQUENCES - _SEQUENCES // 2

    def _restart(self, packet: RtpPacket) -> int:
        """Begin with a packet of another run of the sender."""
        self.ssrc, self.arrivals = packet.ssrc, Arrivals(highest=packet.sequence)
        self._next, self._transit = packet.sequence, None
        self._waiting.clear()
        self._gaps.clear()
        return packet.sequence

    def _measure_jitter(self, packet: RtpPacket, now: int) -> None:
        transit = now * CLOCK_HZ / 1e9 - packet.timestamp
        if self._transit is not None:
            # The timestamps start again after 2**32; such a step is no jitter.
            change = abs(transit - self._transit)
            if change < CLOCK_HZ:
                self.arrivals.jitter += (change - self.arrivals.jitter) / 16
        self._transit = transit
