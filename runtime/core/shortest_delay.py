"""Filter for the shortest delay of messages from one clock to another one, whose difference and drift are not known.

Each message tells when it was sent, by the clock of the sender, and when it arrived, by the clock of the receiver. The
difference contains that of the clocks and the delay. Queues only ever add to the delay, so the smallest differences are
those of the clocks plus the shortest delay. The method is that of V. Paxson, On Calibrating Measurements of Packet
Transit Times (SIGMETRICS 1998): the smallest difference in each of some blocks of time, and the median of the slopes
between the blocks as the drift. Unlike the convex hull of Zhang, Liu and Xia (Clock Synchronization Algorithms for
Network Measurements, INFOCOM 2002), which ROS's cuckoo_time_translator uses, it follows a changed route at once.

Times are in nanoseconds, each of its own clock.
"""

from __future__ import annotations

import itertools
import statistics
from typing import NamedTuple

BLOCK_NS = 2_000_000_000
_BLOCKS = 32
"""Blocks from which the drift is computed."""
_RECENT = 10
"""Blocks from which the shortest delay is computed: over this time, an error of the drift is small."""
LEAST = 5
"""Least number of recent blocks with messages, without which too little is known."""
_CRYSTAL = 5e-5
"""Usual drift of a quartz crystal. A drift that is measured far less exactly than this is taken for 0."""
_FLAT = 1.25 * 3.46
"""Standard deviation of a fitted slope, for a mean absolute residual of 1 and blocks that are 1 apart, times n^1.5."""


class _Point(NamedTuple):
    """Message of a block that had the shortest delay."""

    sent: int
    difference: int
    """Time of arrival minus time of sending."""


class ShortestDelay:
    """Filter for the messages of one sender; see the module. The order of the messages may differ a little."""

    def __init__(self) -> None:
        self._points: list[_Point] = []  # at most one a block
        self._block = 0  # number of the last block
        self._recent: list[_Point] = []
        self.drift = 0.0
        """Receiver's clock against the sender's: 1e-6 if the receiver's gains a microsecond each second."""

    def add(self, sent: int, arrived: int) -> None:
        """Take a message."""
        point, block = _Point(sent, arrived - sent), sent // BLOCK_NS
        if not self._points or block > self._block:
            self._block = block
            self._points = [one for one in self._points if one.sent // BLOCK_NS > block - _BLOCKS]
            if len(self._points) >= LEAST:
                self.drift = _drift(self._points)
            self._points.append(point)
            self._recent = [one for one in self._points if one.sent // BLOCK_NS > block - _RECENT]
        elif point.difference < self._carried(self._points[-1], sent):
            self._points[-1] = self._recent[-1] = point

    def arrival(self, sent: int) -> int:
        """Return the earliest time at which a message that was sent at a time arrives; at least one was added."""
        return sent + round(min([self._carried(point, sent) for point in self._recent]))

    @property
    def blocks(self) -> int:
        """Number of recent blocks with messages; `LEAST` are enough to know something."""
        return len(self._recent)

    @property
    def uncertainty(self) -> float | None:
        """Largest usual error of `arrival` in nanoseconds, apart from the shortest delay itself; None if unknown."""
        recent = self._recent
        if len(recent) < LEAST:
            return None
        differences = [self._carried(point, recent[-1].sent) for point in recent]
        # If queues are rarely empty, the blocks differ. A wrong drift makes them differ as well.
        return 3 * (statistics.fmean(differences) - min(differences))

    def _carried(self, point: _Point, sent: int) -> float:
        """Return what the difference of a point would be at another time."""
        return point.difference + self.drift * (sent - point.sent)


def _drift(points: list[_Point]) -> float:
    """Return the slope of some points: the less exact it is, the nearer to 0."""
    slopes = [
        (after.difference - before.difference) / (after.sent - before.sent)
        for before, after in itertools.combinations(points, 2)
        if after.sent != before.sent
    ]
    slope, first = statistics.median(slopes), points[0]
    levels = [point.difference - first.difference - slope * (point.sent - first.sent) for point in points]
    middle = statistics.median(levels)
    spread = statistics.fmean(abs(level - middle) for level in levels)
    deviation: float = _FLAT * spread / (len(points) ** 1.5 * BLOCK_NS)
    usual = max(_CRYSTAL, abs(slope) - 3 * deviation)  # an RC oscillator drifts by 1 %, and shows it clearly
    return slope / (1 + (deviation / usual) ** 2)
