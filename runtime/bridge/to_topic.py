"""Path of one row from its peer to its topic: limit the rate, publish and count."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from roverlink.runtime.bridge.account import Account
from roverlink.runtime.bridge.limited_row import LimitedRow
from roverlink.runtime.core.errors import DatagramError, Reason
from roverlink.runtime.core.handler import Route, SendLimits
from roverlink.runtime.middleware import NOT_ACCEPTED, Publisher

Drop = Callable[[DatagramError], None]


class InboundRow(LimitedRow):
    """Inbound row: publishes the messages of one row on its topic, with the limit of its rate if it has one."""

    def __init__(self, route: Route, publisher: Publisher, account: Account, drop: Drop) -> None:
        super().__init__(SendLimits(route.max_rate))
        self._route, self._publish, self._account, self._drop = route, publisher.publish, account, drop
        self.publisher = publisher
        """Publisher of the row's own topic."""

    def not_accepted(self) -> None:
        """Count a message that the middleware has not accepted as dropped."""
        what = f"{self._route.name} ({self._route.number})"
        self._drop(DatagramError(Reason.NOT_PUBLISHED, f"{what}: {NOT_ACCEPTED}", self._route.name))

    def _count_superseded(self, count: int) -> None:
        self._account.dropped[Reason.SUPERSEDED.value] += count

    def _pass_on(self, messages: Sequence[bytes]) -> None:
        """Publish messages in order. The messages that the middleware does not accept count as dropped."""
        accepted = self._publish(messages)
        self._account.count_published(self._route.name, accepted)
        for _ in messages[accepted:]:
            self.not_accepted()

    def _repeat(self, datagram: bytes) -> int:  # noqa: ARG002  # as other rows
        return 0  # no table limits a topic to changes
