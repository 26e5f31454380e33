"""Path of one row from its peer to its topic: limit the rate, publish and count."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Sequence

from roverlink.runtime.bridge.account import Account
from roverlink.runtime.bridge.pacing import Pacer
from roverlink.runtime.core.errors import DatagramError, Reason
from roverlink.runtime.core.handler import Route
from roverlink.runtime.middleware import NOT_ACCEPTED, Publisher
from roverlink.runtime.native.shared_lock import SharedLock

Drop = Callable[[DatagramError], None]


class InboundRow:
    """Inbound row: publishes the messages of one row on its topic. To be used from the receiving thread."""

    def __init__(self, route: Route, publisher: Publisher, account: Account, drop: Drop) -> None:
        self._route, self._publish, self._account, self._drop = route, publisher.publish, account, drop
        self.publisher = publisher
        """Publisher of the row's own topic."""
        self.pacer: Pacer | None = None
        """Limit of the rate; None without one."""
        self.lock: threading.Lock | SharedLock = threading.Lock()
        """Lock to hold while messages are limited and published."""
        self.wake: Callable[[], None] = lambda: None
        """Function that wakes the timekeeper of a row with a limit."""

    def take(self, messages: Sequence[bytes]) -> None:
        """Publish messages in order. The messages that the middleware does not accept count as dropped."""
        accepted = self._publish(messages)
        self._account.published[self._route.name] += accepted
        for _ in messages[accepted:]:
            self.not_accepted()

    def not_accepted(self) -> None:
        """Count a message that the middleware has not accepted as dropped."""
        what = f"{self._route.name} ({self._route.number})"
        self._drop(DatagramError(Reason.NOT_PUBLISHED, f"{what}: {NOT_ACCEPTED}", self._route.name))


class PacedInboundRow(InboundRow):
    """Inbound row with a rate limit (table key ``max_rate``): publishes at most ``rate`` messages a second.

    A message that comes too early waits, and a newer message replaces it. Used from the receiving thread and from the
    timekeeper's thread.
    """

    def __init__(self, route: Route, publisher: Publisher, account: Account, drop: Drop, rate: float) -> None:
        super().__init__(route, publisher, account, drop)
        self.pacer: Pacer = Pacer(rate)

    def take(self, messages: Sequence[bytes]) -> None:
        """Publish the newest message, or let it wait if the rate limit forbids it now.

        The other messages, and a message that waited before, count as superseded.
        """
        with self.lock:
            passing, superseded = self.pacer.offer(messages, time.monotonic())
            self._account.dropped[Reason.SUPERSEDED.value] += superseded
            if passing:
                super().take(passing)
        # Outside of the lock, because `wake` makes the timekeeper take the lock at once.
        if not passing:
            self.wake()

    def run_due(self, now: float) -> None:
        """Publish the waiting message if the rate limit allows it now."""
        # If the receiving thread holds the lock, it is publishing right now; the next round looks again.
        if self.pacer.waits and self.lock.acquire(blocking=False):
            try:
                if (message := self.pacer.take(now)) is not None:
                    super().take([message])
            finally:
                self.lock.release()

    @property
    def next_due(self) -> float:
        """Time at which the waiting message may be published; infinity if none waits."""
        slot = self.pacer.next_slot
        return math.inf if slot is None else slot

    def end(self) -> None:
        """Publish the waiting message, if any. Call it when no more datagrams arrive."""
        if (message := self.pacer.withdraw()) is not None:
            super().take([message])
