"""Clock of a board, which counts since its start: from its values to the ages of measurements (table key ``clock``).

The clock is compared with one of this computer that never jumps, so that setting this computer's time changes no age.
A value has 32 or 64 bits; after the largest one, the counter starts again at 0. A value is strange if it fell back or
does not fit the time that has passed. Such a message gets the time of its receipt. Two strange values one after the
other that fit each other are a new start of the board: everything that was known is forgotten. So is a new session of
its link messages.

Nothing that goes in one direction only can tell the shortest delay. So half of the shortest round trip is the rest of
each age, if link messages have measured it; else ages are too short by the shortest delay.

Times are in nanoseconds.
"""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from typing import NamedTuple

from roverlink.runtime.core.handler import BoardStamp
from roverlink.runtime.core.link_statistics import Exchange
from roverlink.runtime.core.shortest_delay import BLOCK_NS, LEAST, ShortestDelay

_LEAST_EXCHANGES = 8
_REORDERED = 1_000_000_000
"""Time by which a datagram may be older than an earlier one."""
_LATE = 5_000_000_000
"""Longest time that a datagram waits on its way. One that seems to arrive that long before it was sent is strange, too.
"""
_AGREEMENT = 500_000_000
"""Largest difference of the time between two values and the time between their arrivals, after a start of the board."""


class ClockReport(NamedTuple):
    """State of the clock of a board, as this computer knows it."""

    problem: str
    """Reason why stamps are times of receipt; empty if they are times of measuring."""
    offset: float | None
    """Clock of the board minus that of this computer, in seconds; None if it is not known, as the next two."""
    drift: float | None
    """Clock of the board against that of this computer: 1e-6 if it gains a microsecond each second."""
    uncertainty: float | None
    """Largest usual error of stamps in seconds."""
    round_trip: float | None
    """Shortest round trip in seconds. Half of it is taken off each stamp, and `uncertainty` contains the other half.

    None if it is not known: stamps are late by the shortest delay, which `uncertainty` does not contain.
    """
    restarts: int
    """Number of starts of the board after the first one."""


class _Arrival(NamedTuple):
    sent: int
    """Time on the clock of the board, with as many bits as it needs."""
    arrived: int
    """Time on the clock of this computer."""


class BoardClock:
    """Clock of one board. The receiving thread gives the messages; another thread may ask for the report."""

    def __init__(self) -> None:
        self._delay = ShortestDelay()
        self._newest: _Arrival | None = None  # by the clock of the board
        self._strange: _Arrival | None = None
        self._unit = 0
        self._restarts = 0
        self._exchanges = 0  # number of the exchanges that were given last
        self._round_trip: int | None = None
        self._unsure = 0  # usual error of the round trip

    def age(self, stamp: BoardStamp, count: int, arrived: int) -> int | None:
        """Take a value of the clock in a message that arrives now, and return how long ago it was measured.

        Returns None if that is not known. A message may be given several times.
        """
        self._unit = stamp.nanoseconds
        sent = self._without_wrap(stamp, count, arrived)
        if self._is_strange(sent, arrived):
            before, self._strange = self._strange, _Arrival(sent, arrived)
            if before is None or not _fit(before, self._strange):
                return None
            self._begin_again(before, stamp.nanoseconds * count - sent)
            sent = stamp.nanoseconds * count
        self._strange = None
        self._delay.add(sent, arrived)
        if self._newest is None or sent > self._newest.sent:
            self._newest = _Arrival(sent, arrived)
        if self._delay.blocks < LEAST:
            return None
        return max(arrived - self._delay.arrival(sent), 0) + self._shortest

    def take_exchanges(self, exchanges: Sequence[Exchange]) -> None:
        """Take the last exchanges of link messages with the board, whose quartz is that of the clock.

        Both ways may have been the fastest in different exchanges, because the drift between them is known.
        """
        # The exchanges begin again with each session of the board. A counter that began again may fit by chance.
        if len(exchanges) < self._exchanges and self._delay.blocks >= LEAST:
            self._restarts += 1
            self._delay, self._newest = ShortestDelay(), None
        self._exchanges = len(exchanges)
        self._round_trip = None
        if len(exchanges) >= _LEAST_EXCHANGES:
            drift, first = -self._delay.drift, exchanges[0].sent
            there = [one.received_there - one.sent - drift * (one.sent - first) for one in exchanges]
            back = [one.arrived - one.sent_there + drift * (one.arrived - first) for one in exchanges]
            (least, unsure), (other, of_other) = _least(there), _least(back)
            self._round_trip = max(round(1000 * (least + other)), 0)
            self._unsure = round(1000 * (unsure + of_other))

    def report(self, ahead: int) -> ClockReport:
        """Return what is known of the clock.

        ``ahead`` is the clock of the arrivals minus that of this computer whose time the report means.
        """
        newest, delay = self._newest, self._delay
        uncertainty = delay.uncertainty if newest is not None else None
        if newest is None or uncertainty is None:
            blocks = delay.blocks if newest is not None else 0
            seconds = BLOCK_NS / 1e9
            problem = f"stamps are times of receipt: messages came in {blocks} of {LEAST} intervals of {seconds:g} s"
            return ClockReport(problem, None, None, None, None, self._restarts)
        offset = newest.sent - delay.arrival(newest.sent) + self._shortest + ahead
        return ClockReport(
            "",
            offset / 1e9,
            -delay.drift,
            (uncertainty + self._unit + self._shortest + (0 if self._round_trip is None else self._unsure)) / 1e9,
            None if self._round_trip is None else self._round_trip / 1e9,
            self._restarts,
        )

    @property
    def _shortest(self) -> int:
        """Shortest delay, as far as it is known."""
        return (self._round_trip or 0) // 2

    def _without_wrap(self, stamp: BoardStamp, count: int, arrived: int) -> int:
        """Return the time of a value that is nearest to the expected one, with all bits."""
        if self._newest is None:
            return stamp.nanoseconds * count
        expected = self._newest.sent + arrived - self._newest.arrived
        wrap = stamp.nanoseconds << stamp.bits
        return expected + (stamp.nanoseconds * count - expected + wrap // 2) % wrap - wrap // 2

    def _is_strange(self, sent: int, arrived: int) -> bool:
        if self._newest is None:
            return False
        return sent < self._newest.sent - _REORDERED or abs(arrived - self._delay.arrival(sent)) > _LATE

    def _begin_again(self, first: _Arrival, shift: int) -> None:
        """Forget everything but a message, whose time has to be shifted: the number of wraps is not known any more."""
        self._restarts += 1
        self._delay = ShortestDelay()
        self._newest = _Arrival(first.sent + shift, first.arrived)
        self._delay.add(*self._newest)


def _least(differences: Sequence[float]) -> tuple[float, float]:
    """Return the difference of a message without any delay by queues, if those are mostly short, and its error."""
    least = min(differences)
    unsure = (statistics.fmean(differences) - least) / (len(differences) - 1)
    return least - unsure, unsure


def _fit(before: _Arrival, after: _Arrival) -> bool:
    """Return true if two arrivals are those of one clock that runs."""
    passed = after.sent - before.sent
    return passed > 0 and abs(passed - (after.arrived - before.arrived)) < _AGREEMENT
