"""Schedule of the datagrams that a peer sends again and again. It uses no socket and no clock."""

from __future__ import annotations

import math
from collections.abc import Callable


class Repetition:
    """Datagram that is sent periodically, until `stop` is called or the peer is closed."""

    def __init__(self, make: Callable[[], bytes], interval: float, now: float) -> None:
        """Send the datagram that ``make`` returns every ``interval`` seconds, for the first time at ``now``."""
        self.make, self._interval, self.next_due = make, interval, now

    def stop(self) -> None:
        """Send the datagram no more. May be repeated."""
        self.next_due = math.inf

    def advance(self, now: float) -> None:
        """Set the time of the next datagram, after one was sent at ``now``."""
        self.next_due += self._interval
        # A program that was busy for a while must not send a burst of old commands.
        if self.next_due <= now:
            self.next_due = now + self._interval


class Schedule:
    """All repetitions of a peer."""

    def __init__(self) -> None:
        self._repetitions: list[Repetition] = []

    def add(self, repetition: Repetition) -> None:
        """Add a repetition, and forget those that have been stopped."""
        self._repetitions = [repetition for repetition in self._repetitions if repetition.next_due < math.inf]
        self._repetitions.append(repetition)

    @property
    def next_due(self) -> float:
        """Time at which the next datagram is due; infinity if there is none."""
        return min((repetition.next_due for repetition in self._repetitions), default=math.inf)

    def take_due(self, now: float) -> list[bytes]:
        """Return the datagrams that are due at ``now``."""
        due = [repetition for repetition in self._repetitions if repetition.next_due <= now]
        for repetition in due:
            repetition.advance(now)
        return [repetition.make() for repetition in due]
