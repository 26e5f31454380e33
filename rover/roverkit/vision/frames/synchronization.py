"""Synchronization of messages from several topics by their stamps. No clock, no thread, no ROS.

The first topic leads. A set has one message of each topic:

- The message of each other topic is the nearest of its topic to the leading message, and the leading message is the
  nearest of the first topic to it. Of two messages at the same distance, the older one is nearer.
- The distance is at most the slop. With a slop of 0, all stamps of a set are equal: exact synchronization.
- No message is in two sets, and the stamps of successive sets increase in every topic. The first two rules ensure this
  if the messages of each topic come in the order of their stamps; otherwise, sets that would break it are left out.
- A set is complete as soon as no later message can change it, if the messages of each topic come in the order of their
  stamps. Equal stamps need no waiting. Otherwise, a set waits for the next message of the topic whose stamp is older.
- Topics may be delayed against each other, by fewer messages than the queue holds. A message that comes after a newer
  message of its own topic is still used, unless a set was decided without it. A second message with the same stamp is
  ignored.
- If the stamps of a topic jump back by more than `RESTART_NS`, such as those of a recording that starts again, then all
  waiting messages are dropped, and the synchronization begins again.
"""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Generic, TypeVar

T = TypeVar("T")

RESTART_NS = 10**9
"""Time in nanoseconds by which the stamps of a topic must jump back to count as a new start."""


@dataclass(slots=True)
class _Waiting(Generic[T]):
    """Messages of one topic that sets may still need: their stamps, ascending, and the messages by stamp."""

    stamps: list[int] = field(default_factory=list)
    messages: dict[int, T] = field(default_factory=dict)
    newest: int | None = None
    used: int | None = None

    def add(self, stamp: int, message: T) -> None:
        if stamp not in self.messages:
            insort(self.stamps, stamp)
            self.messages[stamp] = message
        self.newest = stamp if self.newest is None else max(self.newest, stamp)

    def drop(self, count: int) -> None:
        for stamp in self.stamps[: max(count, 0)]:
            del self.messages[stamp]
            self.stamps.remove(stamp)

    def is_past(self, stamp: int) -> bool:
        """Return true if the message that is nearest to a stamp must have come."""
        return self.newest is not None and self.newest >= stamp

    def is_unused(self, stamp: int) -> bool:
        return self.used is None or stamp > self.used

    def use(self, stamp: int) -> T:
        self.used = stamp
        return self.messages[stamp]

    def nearest(self, stamp: int) -> int | None:
        place = bisect_left(self.stamps, stamp)
        return min(self.stamps[max(place - 1, 0) : place + 1], key=lambda other: abs(other - stamp), default=None)


class Synchronizer(Generic[T]):
    """Queues of the messages of several topics, from which sets are made by the rules of this module."""

    def __init__(self, topics: int, slop_ns: int = 0, queue: int = 10) -> None:
        """Create the queues; ``slop_ns`` is the largest distance of stamps in nanoseconds.

        ``queue`` is the number of messages of each topic that wait for those of the other topics.
        """
        self._slop, self._queue = slop_ns, queue
        self._topics: list[_Waiting[T]] = [_Waiting() for _ in range(topics)]
        self._decided: int | None = None  # stamp of the newest leading message for which the set is decided

    def add(self, topic: int, stamp: int, message: T) -> list[tuple[T, ...]]:
        """Add a message of the topic with this index; return the sets that are now complete, the oldest first."""
        waiting = self._topics[topic]
        if waiting.newest is not None and stamp < waiting.newest - RESTART_NS:
            self._topics[:] = [_Waiting() for _ in self._topics]
            self._decided, waiting = None, self._topics[topic]
        if topic:
            waiting.add(stamp, message)
            waiting.drop(len(waiting.stamps) - self._queue)
        elif self._decided is None or stamp > self._decided:
            waiting.add(stamp, message)
        complete = list(self._complete())
        undecided = self._undecided()
        if len(undecided) > self._queue:
            self._decide(undecided[0])
        return complete

    def _undecided(self) -> list[int]:
        stamps = self._topics[0].stamps
        # The newest one that is decided is still in the queue, see `_decide`.
        return stamps if self._decided is None else stamps[bisect_left(stamps, self._decided + 1) :]

    def _complete(self) -> Iterator[tuple[T, ...]]:
        leading, *others = self._topics
        while undecided := self._undecided():
            stamp = undecided[0]
            if not all(other.is_past(stamp) for other in others):
                return
            near = [other.nearest(stamp) for other in others]
            partners = [partner for partner in near if partner is not None and abs(partner - stamp) <= self._slop]
            if len(partners) == len(others):
                if not all(leading.is_past(partner) for partner in partners):
                    return
                if all(
                    leading.nearest(partner) == stamp and other.is_unused(partner)
                    for partner, other in zip(partners, others)
                ):
                    yield tuple(waiting.use(partner) for waiting, partner in zip(self._topics, (stamp, *partners)))
            self._decide(stamp)

    def _decide(self, stamp: int) -> None:
        """Drop the messages that no later set can need, after the set of a leading message was decided."""
        self._decided = stamp
        for waiting in self._topics:
            # The newest one that is not later is kept: it may be nearer to a later message than all others, and must
            # not leave its place to a message that is farther.
            waiting.drop(bisect_left(waiting.stamps, stamp + 1) - 1)
