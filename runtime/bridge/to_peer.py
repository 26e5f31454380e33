"""Path of one row from its topic to its peer: translate, limit the rate, detect silence, send and count.

The middleware's thread calls `OutboundRow.take`; the timekeeper's thread calls `OutboundRow.run_due`. A lock keeps the
datagrams in order. If the lock is taken, `run_due` does not wait for it: the middleware's thread may hold the lock and
be blocked, and the stop must be sent also in that case. The stop is the datagram that makes the peer stop (table key
``deadman``).
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence

from roverlink.runtime.bridge.account import Account, ThrottledWarnings
from roverlink.runtime.bridge.deadman import Watchdog
from roverlink.runtime.bridge.limited_row import LimitedRow
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.core.handler import SendLimits
from roverlink.runtime.core.registry import AnyHandler
from roverlink.runtime.core.translator import Translator
from roverlink.runtime.middleware import Subscription, WatchedSubscription
from roverlink.runtime.text.assignments import payload_from_assignments

_STOP_COPIES = 3
"""Number of times that the stop is sent at shutdown, because UDP may lose a datagram and nobody sends it later."""
_LOOK_S = 0.1
"""Time in seconds after which the loss of a publisher is noticed at most."""
# A full buffer or a moment without radio link usually takes neighbouring datagrams, so the copies go out apart.
_STOP_PAUSE_S = 0.02

Send = Callable[[Sequence[bytes]], int]
"""Function that sends datagrams to the row's peer and returns how many of them the network accepted."""


class OutboundRow(LimitedRow):
    """Outbound row: sends the messages of one topic to the row's peer.

    If the topic is silent, it sends the stop, a datagram that makes the peer stop (table key ``deadman``).
    """

    def __init__(
        self, handler: AnyHandler, translator: Translator, send: Send, account: Account, warnings: ThrottledWarnings
    ) -> None:
        route, limits = handler.route, handler.route.send or SendLimits()
        super().__init__(SendLimits(route.max_rate, limits.on_change, limits.at_least_ms))
        self._handler, self._translator, self._send = handler, translator, send
        self._account, self._warnings = account, warnings
        self.name = route.name
        self._watchdog: Watchdog | None = None
        self._stop = b""
        if deadman := route.deadman:
            self._watchdog = Watchdog(deadman.after_ms / 1000, deadman.repeat_ms / 1000, time.monotonic())
            self._stop = translator.datagram(handler, payload_from_assignments(handler.payload_type, deadman.send))
        self.refused = False
        """True if no message is sent, because the peer has another schema of the row's payload.

        The stop is sent all the same: it is safer than silence, and most stops are empty, which means the same in every
        schema.
        """
        self._ended = False

    @property
    def is_timed(self) -> bool:
        """True if the row has limits or a watchdog, so that a `Timekeeper` has to run it."""
        return self.is_limited or self._watchdog is not None

    def connect(self, subscription: Subscription, wake: Callable[[], None]) -> PublisherWatch | None:
        """Store ``wake``, the function that wakes the timekeeper of this row.

        Returns a `PublisherWatch` for ``subscription`` if the topic has a watchdog and the middleware does not tell of
        publishers itself, else None. The caller must run the `PublisherWatch` as a timed task.
        """
        self.wake = wake
        if self._watchdog is None:
            return None
        watch = PublisherWatch(subscription, self._watchdog, wake)
        if not isinstance(subscription, WatchedSubscription):
            return watch
        subscription.watch(watch.tell)
        return None

    def _take(self, messages: Sequence[bytes]) -> None:
        self._account.taken[self.name] += len(messages)
        if self._ended:
            self._account.superseded[self.name] += len(messages)
        else:
            super()._take(messages)

    def count_late(self) -> None:
        """Count a message that came more than a second late, and is therefore not sent; log a warning."""
        with self.lock:
            self._account.taken[self.name] += 1
            self._account.late[self.name] += 1
        self._warnings.warn(
            f"late {self.name}",
            f"not sent: {self.name}: the message came more than a second late, because a link has held it back "
            "or this computer is too slow",
        )

    def run_due(self, now: float) -> None:
        """Send the stop if it is due; otherwise the waiting message if its time has come, or the last one again."""
        if self._watchdog and self._stop_is_due(self._watchdog, now):
            self._tell_to_stop()
        else:
            super().run_due(now)

    @property
    def next_due(self) -> float:
        """Time at which `run_due` has something to do, unless a message arrives before."""
        stop = self._watchdog.next_due if self._watchdog else math.inf
        return min(stop, self._next_pass)

    def end(self) -> None:
        """Send the last datagram at shutdown: the waiting message, or the stop if the row has a watchdog.

        Call it when no more messages arrive.
        """
        if self._watchdog is None:
            super().end()
            return
        # A command that waits must not go out, nor one of a thread that hung: the stop has to be the last word.
        self._ended = True
        self._count_superseded(self.pacer is not None and self.pacer.withdraw() is not None)
        for _ in range(_STOP_COPIES):
            self._account.count_stops(self.name, self._send([self._stop]))
            time.sleep(_STOP_PAUSE_S)

    def _pass_on(self, messages: Sequence[bytes]) -> None:
        if self.refused:
            self._account.refused[self.name] += len(messages)
            self._warnings.warn(self.name, f"not sent: {self.name}: {self._handler.route.peer} has another schema")
            return
        datagrams = []
        for message in messages:
            try:
                datagrams.append(self._translator.send(self._handler, message))
            except ConversionError as error:
                self._account.refused[self.name] += 1
                self._warnings.warn(self.name, f"not sent: {error}")
        chosen = self._changed(datagrams)
        if unchanged := len(datagrams) - len(chosen):
            self._account.unchanged[self.name] += unchanged
        self._send_and_count(chosen)

    def _count_superseded(self, count: int) -> None:
        if count:
            self._account.superseded[self.name] += count

    def _repeat(self, datagram: bytes) -> int:
        """Send the last datagram once more; it is no message of the topic, so the other counters leave it out."""
        sent = 0 if self.refused or self._ended else self._send([datagram])
        self._account.repeated[self.name] += sent
        return sent

    def send_again(self, datagram: bytes) -> None:
        """Send a datagram that the native core has made but could not send, and count it."""
        with self.lock:
            if self._ended:
                self._account.superseded[self.name] += 1
            else:
                self._send_and_count([datagram])

    def follow(self, last_sent: Callable[[], float]) -> None:
        """Let the watchdog, if the row has one, ask when the native core last sent a datagram of the row."""
        if self._watchdog is not None:
            self._watchdog.last_sent = last_sent

    def _send_and_count(self, datagrams: Sequence[bytes]) -> None:
        sent = self._send(datagrams)
        # The watchdog is about commands that leave the bridge, so a message that could not be sent does not count.
        if sent:
            self._account.count_sent(self.name, sent)
            if self._watchdog:
                self._watchdog.message_passed(time.monotonic())
        if failed := len(datagrams) - sent:
            self._account.failed[self.name] += failed
            self._not_sent()

    def _stop_is_due(self, watchdog: Watchdog, now: float) -> bool:
        """Return true if the stop must be sent now. Log a warning when the topic has just become silent."""
        was_silent = watchdog.silent
        if not watchdog.is_due(now):
            return False
        if not was_silent:
            self._warnings.warn(
                f"silent {self.name}",
                f"{self.name}: the topic is silent, so the bridge sends the stop payload (table key deadman) to the "
                "peer",
            )
        return True

    def _tell_to_stop(self) -> None:
        """Send the stop and discard the waiting message, so that no older command follows the stop."""
        if self.pacer is not None and self.lock.acquire(blocking=False):
            self._count_superseded(self.pacer.withdraw() is not None)
            self.lock.release()
        self._account.count_stops(self.name, self._send([self._stop]))


class PublisherWatch:
    """Timed task that tells a watchdog when the last publisher of its topic leaves.

    It runs on another thread than the task that sends the stop. Asking the middleware for publishers can block, if a
    thread of the middleware hangs, and the stop must not wait for that.
    """

    def __init__(self, subscription: Subscription, watchdog: Watchdog, wake: Callable[[], None]) -> None:
        self._subscription, self._watchdog, self._wake = subscription, watchdog, wake
        self._published = False
        self.next_due = 0.0

    def run_due(self, now: float) -> None:
        """Make the stop due if the topic had a publisher at the last call and has none now."""
        self.next_due = now + _LOOK_S
        published = self._subscription.has_publishers()
        if self._published and not published:
            self.tell()
        self._published = published

    def tell(self) -> None:
        """Make the stop due, because the last publisher has left."""
        self._watchdog.lost_publisher()
        self._wake()
