"""The rows' further topics: what each gets of a batch is published, and what it does not get is counted."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence

from roverlink.runtime.bridge.account import Account, ThrottledWarnings
from roverlink.runtime.core.handler import Serialized
from roverlink.runtime.core.registry import AnyFeed
from roverlink.runtime.interfaces import Time


def now() -> Time:
    """The time of day, for what is received at this moment."""
    return Time(*divmod(time.time_ns(), 1_000_000_000))


class Feeding:
    """Publishes to the further topics that were opened."""

    def __init__(self, account: Account, warnings: ThrottledWarnings) -> None:
        self._account, self._warnings = account, warnings
        self._publish: dict[AnyFeed, Callable[[Sequence[bytes]], int]] = {}

    def open(self, feed: AnyFeed, publish: Callable[[Sequence[bytes]], int]) -> None:
        """Publish what a feed makes by a function that says how many it took."""
        self._publish[feed] = publish

    def publish(self, fed: Iterable[tuple[AnyFeed, Serialized]]) -> None:
        """Publish a batch, each topic's messages in one run."""
        for feed, (messages, misfits) in fed:
            for error in misfits.values():
                self._missed(feed, 1, str(error))
            accepted = self._publish[feed](messages) if messages else 0
            self._account.fed[feed.route.topic] += accepted
            if accepted < len(messages):
                self._missed(feed, len(messages) - accepted, f"{feed.route.topic}: its subscribers are too slow")

    def _missed(self, feed: AnyFeed, count: int, why: str) -> None:
        self._account.unfed[feed.route.topic] += count
        self._warnings.warn(f"unfed {feed.route.topic}", f"not published: {why}")
