"""Control of the bitrate of a stream by what its receiver reports, or what the link measures.

Under congestion, first the frame rate is halved, and then each image gets fewer bits. Without it, the images get
their bits back first. Random losses of a radio are no congestion; a queue that grows is, before it loses packets.
"""

from __future__ import annotations

from dataclasses import dataclass

CONGESTED_LOSS = 0.1
"""Part of lost packets above which the link is congested, as in Google's congestion control (RFC draft, 2016)."""
CONGESTED_DELAY_S = 0.1
"""Growth of the round trip in seconds above which a queue on the link grows."""
_GOOD_LOSS = 0.02
_LESS = 0.75
_MORE = 1.1
_PAUSE_S = 0.9
"""Least time between two reductions: a report shows the effect of the one before only then."""
_GOOD_S = 2.0
_FULL_S = 5.0
"""Time without congestion after which the full frame rate is tried again; it doubles after each failure."""
_LONGEST_S = 80.0


@dataclass(frozen=True, slots=True)
class Plan:
    """What the encoder should do."""

    bitrate: float
    """Bits a second."""
    divisor: int
    """1 for all images, 2 for every other one."""


class RateControl:
    """Control of one stream. Times are in seconds of a clock that never jumps."""

    def __init__(self, lowest: float, highest: float) -> None:
        """Keep the bitrate from `lowest` to `highest`, in bits a second; it starts as `highest`."""
        self._lowest, self._highest = lowest, highest
        self._quality, self._divisor = 1.0, 1
        self._round_trip: float | None = None
        self._changed = self._good_since = -_LONGEST_S
        self._patience, self._raised = _FULL_S, -_LONGEST_S

    @property
    def plan(self) -> Plan:
        """Plan that follows from the reports until now."""
        return Plan(max(self._lowest, self._highest * self._quality / self._divisor), self._divisor)

    def report(self, lost: float, round_trip: float | None, now: float) -> Plan:
        """Take the part of packets that were lost recently, and the round trip in seconds if it is known."""
        grown = 0.0
        if round_trip is not None:
            # The shortest round trip is that of the empty link; it rises slowly, because links change.
            known = round_trip if self._round_trip is None else self._round_trip * 1.01
            self._round_trip = min(known, round_trip)
            grown = round_trip - self._round_trip
        if lost > CONGESTED_LOSS or grown > CONGESTED_DELAY_S:
            self._good_since = now
            if now - self._changed >= _PAUSE_S:
                self._changed = now
                self._reduce(now)
        elif lost > _GOOD_LOSS:
            self._good_since = now
        elif now - self._good_since >= _GOOD_S and now - self._changed >= _PAUSE_S:
            self._raise(now)
        return self.plan

    def _reduce(self, now: float) -> None:
        if self._divisor == 1:
            self._divisor = 2
            failed = now - self._raised < _FULL_S
            self._patience = min(2 * self._patience, _LONGEST_S) if failed else _FULL_S
        elif self._highest * self._quality / self._divisor > self._lowest:
            self._quality *= _LESS

    def _raise(self, now: float) -> None:
        if self._quality < 1:
            self._quality = min(1.0, self._quality * _MORE)
            self._changed = now
        elif self._divisor > 1 and now - self._good_since >= self._patience:
            self._divisor = 1
            self._changed = self._raised = now
