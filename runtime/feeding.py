"""The rows' further topics: what each gets of a batch is published, and what it does not get is counted."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable, Sequence

from runtime.account import Account, ThrottledWarnings
from runtime.interfaces import Time
from runtime.registry import AnyFeed
from runtime.translator import Fed


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

    def publish(self, fed: Sequence[Fed]) -> None:
        """Publish a batch, each topic's messages in one run."""
        runs: defaultdict[AnyFeed, list[bytes]] = defaultdict(list)
        for feed, message in fed:
            if isinstance(message, bytes):
                runs[feed].append(message)
            else:
                self._missed(feed, 1, str(message))
        for feed, run in runs.items():
            accepted = self._publish[feed](run)
            self._account.fed[feed.route.topic] += accepted
            if accepted < len(run):
                self._missed(feed, len(run) - accepted, f"{feed.route.topic}: its subscribers are too slow")

    def _missed(self, feed: AnyFeed, count: int, why: str) -> None:
        self._account.unfed[feed.route.topic] += count
        self._warnings.warn(f"unfed {feed.route.topic}", f"not published: {why}")
