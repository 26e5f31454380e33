"""Datagrams that wait for the line to an end. It has no thread, no socket and no clock: times are arguments.

The datagram of the highest priority goes first; within a priority, they go in order. One that has waited for half a
second is not sent any more, so that what does not fit is the oldest of the lowest priorities.

With a budget of B bytes a second, no interval of one second sees more than B bytes. A bucket gives this guarantee: it
holds at most D bytes, and B - D bytes flow into it in a second. D has two parts:
- Only urgent datagrams use the reserve. It holds the largest of them, so that an urgent datagram goes at once if none
  went before it, whatever else waits.
- The others use the rest. It holds the largest of them, or what the budget allows in 5 ms, so that a timer may be late.
"""

from __future__ import annotations

import math
from collections import Counter, deque
from collections.abc import Callable
from enum import Enum
from typing import Generic, TypeVar

from roverlink.runtime.core.registry import Registry
from roverlink.runtime.core.wire_format import fields

URGENT = 9
"""Least priority of the datagrams that may use the reserve: that of rows with a deadman."""
FIRST = 10
"""Priority of the link message, above those of all rows."""
_STALE_S = 0.5
"""Age in seconds at which a datagram is not sent any more: a command of the past must not move a rover."""
_MOST = 1024
_BURST_S = 0.005
_USUAL = 1_500  # bytes for which there is room from the start
_ROUNDING = 1e-3  # bytes
_SHARE = 8  # of a small budget, the bucket's parts have an eighth each; a datagram may have a quarter

T = TypeVar("T")


class Undelivered(str, Enum):
    """Reason why a datagram that the program has sent to an end did not leave this computer."""

    STALE = "stale"
    """It waited for the line too long."""
    OVER_BUDGET = "over_budget"
    """It waited too long, because the peer's `budget` was used up by datagrams of a higher priority, or older ones."""
    OVERFLOW = "overflow"
    """Too many datagrams waited for the line."""
    NOT_CONNECTED = "not_connected"
    """There is no connection to the end."""
    NOT_TAKEN = "not_taken"
    """The end did not take it, as a board on a CAN bus that is switched off."""
    STOPPED = "stopped"
    """The program stopped before the line was free."""
    TOO_LARGE = "too_large"
    """The transport cannot carry so many bytes, or they are more than a quarter of a second's budget."""


def number_of(datagram: bytes, signature: int | None) -> int:
    """Return the number of a datagram's payload; 0 if it has none. ``signature`` is that of the signature's field."""
    return next((field.number for field in fields(datagram) if field.number != signature), 0)


def priority_by_number(registry: Registry) -> Callable[[int], int]:
    """Return a function that returns the priority of a payload by its number, from 0 to `FIRST`."""
    routes = [handler.route for handler in registry.handlers]
    priorities = {route.number: URGENT if route.deadman else route.priority for route in routes}
    if registry.link is not None:
        priorities[registry.link.number] = FIRST
    return lambda number: priorities.get(number, 0)


class Outbox(Generic[T]):
    """Queue of the datagrams to one end. To be used from one thread; another one may read the counts.

    The items are datagrams, or what their sender needs besides.
    """

    def __init__(
        self,
        priority_of: Callable[[T], int] = lambda _: 0,
        budget: int | None = None,
        discard: Callable[[T, Undelivered], None] = lambda *_: None,
    ) -> None:
        """Order the items by ``priority_of``, from 0 to `FIRST`, and let at most ``budget`` bytes leave in a second.

        Without a budget, all leave. ``discard`` gets each discarded item.
        """
        self.undelivered: Counter[str] = Counter()
        """Datagrams that were discarded, by reason (`Undelivered`)."""
        self.sent_bytes = 0
        """Bytes of the datagrams that were taken."""
        self._priority_of, self._discard = priority_of, discard
        # Each item with the time since when it waits, and its size.
        self._queues: tuple[deque[tuple[float, int, T]], ...] = tuple(deque() for _ in range(FIRST + 1))
        self._count = 0
        self._bucket = None if budget is None else _Bucket(budget)

    def put(self, item: T, now: float, size: int = 0) -> None:
        """Add a datagram that the program sends at the time ``now``; ``size`` are its bytes on the line."""
        priority = self._priority_of(item)
        if self._bucket is not None and not self._bucket.has_room_for(size, priority >= URGENT):
            self._refuse(item, Undelivered.TOO_LARGE)
            return
        self._queues[priority].append((now, size, item))
        self._count += 1
        if self._count > _MOST:
            self._remove(next(queue for queue in self._queues if queue), Undelivered.OVERFLOW)

    def take(self, now: float) -> T | None:
        """Remove and return the datagram to send now; None if there is none, or if it is not yet due."""
        for queue in self._queues:
            while queue and now - queue[0][0] >= _STALE_S:
                self._remove(queue, Undelivered.STALE if self._bucket is None else Undelivered.OVER_BUDGET)
        priority = self._first()
        if priority is None:
            return None
        _, size, item = self._queues[priority][0]
        if self._bucket is not None and not self._bucket.pays(size, priority >= URGENT, now):
            return None
        self._queues[priority].popleft()
        self._count -= 1
        self.sent_bytes += size
        return item

    def has_left(self, size: int, now: float) -> None:
        """Take note that the datagram of the last `take` left at the time ``now``, which may be much later."""
        if self._bucket is not None:
            self._bucket.has_left(size, now)

    def discard(self) -> None:
        """Discard what waits, because the program stops."""
        for queue in self._queues:
            while queue:
                self._remove(queue, Undelivered.STOPPED)

    @property
    def next_due(self) -> float:
        """Time at which `take` should be called again; infinity if nothing waits."""
        priority = self._first()
        if priority is None:
            return math.inf
        since, size, _ = self._queues[priority][0]
        return since if self._bucket is None else max(since, self._bucket.time_for(size, priority >= URGENT))

    def _first(self) -> int | None:
        return next((priority for priority in range(FIRST, -1, -1) if self._queues[priority]), None)

    def _remove(self, queue: deque[tuple[float, int, T]], why: Undelivered) -> None:
        self._count -= 1
        self._refuse(queue.popleft()[2], why)

    def _refuse(self, item: T, why: Undelivered) -> None:
        self.undelivered[why.value] += 1
        self._discard(item, why)


class _Bucket:
    """Bytes that may leave now. Its parts grow with the datagrams, and never shrink: the guarantee stays true then."""

    def __init__(self, budget: int) -> None:
        self._budget = budget
        usual = min(_USUAL, budget // _SHARE)
        self._reserve, self._rest = usual, max(usual, math.ceil(budget * _BURST_S))
        self._level, self._at = float(self._reserve + self._rest), -math.inf

    @property
    def _rate(self) -> int:
        return self._budget - self._reserve - self._rest - 1  # one byte for what is rounded

    def has_room_for(self, size: int, is_urgent: bool) -> bool:
        """Return true if a datagram of this size can ever leave."""
        if size > 2 * self._budget // _SHARE:
            return False
        if is_urgent:
            self._reserve = max(self._reserve, size)
        else:
            self._rest = max(self._rest, size)
        return True

    def pays(self, size: int, is_urgent: bool, now: float) -> bool:
        """Remove the bytes of a datagram, and return true; false if it has to wait."""
        self._flow(now)
        if self._level < self._needed(size, is_urgent) - _ROUNDING:
            return False
        self._level -= size
        return True

    def has_left(self, size: int, now: float) -> None:
        """Let the bucket be as if the datagram had paid at this later time: a full one takes nothing meanwhile."""
        self._level += size
        self._flow(now)
        self._level -= size

    def time_for(self, size: int, is_urgent: bool) -> float:
        """Return the time at which there are enough bytes for a datagram."""
        return self._at + max(0.0, self._needed(size, is_urgent) - self._level) / self._rate

    def _flow(self, now: float) -> None:
        if now > self._at:
            flowed = self._rate * (now - self._at) if self._at > -math.inf else 0.0
            self._level, self._at = min(self._level + flowed, self._reserve + self._rest), now

    def _needed(self, size: int, is_urgent: bool) -> int:
        return size if is_urgent else size + self._reserve
