"""Detection of messages that a link has held back, although the clocks of two computers differ.

TCP keeps what it cannot deliver. After a gap in a radio link, it would deliver all commands of the gap at once, and the
rover would obey old ones. The time that a message takes cannot be measured, but how much longer it took than others of
the same sender can: the difference between the time of its arrival and its own time, less the smallest such difference.
"""

from __future__ import annotations

import math

LATE_NS = 1_000_000_000  # a computer with too much work delays messages by less
_PERIOD_NS = 30_000_000_000  # a difference that lasts longer is one of the clocks


class Delay:
    """Delay of the messages of one sender, which arrive in the order in which they were sent."""

    def __init__(self) -> None:
        self._last_sent = 0
        self._began = -math.inf
        self._before = self._smallest = math.inf

    def of(self, sent: int, arrived: int) -> float:
        """Return how much longer a message took than others of the last half minute to a minute, in ns.

        ``sent`` is the time by the sender's clock, ``arrived`` by a monotonic clock of this computer, both in ns.
        """
        if sent < self._last_sent:  # the sender's clock was set back
            self._before = self._smallest = math.inf
        self._last_sent = sent
        if arrived - self._began > _PERIOD_NS:
            self._before, self._smallest, self._began = self._smallest, math.inf, arrived
        difference = arrived - sent
        self._smallest = min(self._smallest, difference)
        return difference - min(self._before, self._smallest)
