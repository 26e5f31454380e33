"""Publishing on the extra topics of rows, with a count of the messages that could not be published."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence

from roverlink.runtime.bridge.account import Account, ThrottledWarnings
from roverlink.runtime.core.handler import Serialized
from roverlink.runtime.core.registry import AnyStandardHandler
from roverlink.runtime.interfaces import Time


def now() -> Time:
    """Return the current wall-clock time, which is used as the receive time of a batch."""
    return Time(*divmod(time.time_ns(), 1_000_000_000))


class ExtraTopics:
    """Publishers of all extra topics."""

    def __init__(self, account: Account, warnings: ThrottledWarnings) -> None:
        self._account, self._warnings = account, warnings
        self._publish: dict[AnyStandardHandler, Callable[[Sequence[bytes]], int]] = {}

    def open(self, handler: AnyStandardHandler, publish: Callable[[Sequence[bytes]], int]) -> None:
        """Add an extra topic; ``publish`` returns how many messages it accepted."""
        self._publish[handler] = publish

    def publish(self, batch: Iterable[tuple[AnyStandardHandler, Serialized]]) -> None:
        """Publish the messages of a batch, with one call of the publisher for each topic.

        ``batch`` holds the handler of each extra topic with the serialized messages for the topic.
        """
        # A value that does not fit must not stop the row's own topic, so it is counted here and not raised.
        for handler, (messages, misfits) in batch:
            for error in misfits.values():
                self._missed(handler, 1, str(error))
            accepted = self._publish[handler](messages) if messages else 0
            self._account.extra_published[handler.route.topic] += accepted
            if accepted < len(messages):
                self._missed(handler, len(messages) - accepted, f"{handler.route.topic}: a subscriber is too slow")

    def _missed(self, handler: AnyStandardHandler, count: int, why: str) -> None:
        self._account.extra_unpublished[handler.route.topic] += count
        self._warnings.warn(f"unpublished {handler.route.topic}", f"not published: {why}")
