"""Period of the images that a detector has searched: times for which an object may be unseen depend on it."""

from __future__ import annotations

import statistics
from collections import deque

_NEWEST = 5
"""Number of the periods whose median counts: a single gap does not change it."""


class FramePeriod:
    """Median time between the newest images."""

    def __init__(self) -> None:
        self._stamp: int | None = None
        self._periods: deque[int] = deque(maxlen=_NEWEST)

    def add(self, stamp: int) -> None:
        """Add an image by its time in nanoseconds. If the time jumps back, the earlier images are forgotten."""
        if self._stamp is not None and stamp >= self._stamp:
            self._periods.append(stamp - self._stamp)
        else:
            self._periods.clear()
        self._stamp = stamp

    def at_least(self, least: int, periods: int) -> int:
        """Return a time in nanoseconds: `least`, or a number of periods if that is longer."""
        return max(least, periods * round(statistics.median(self._periods))) if self._periods else least
