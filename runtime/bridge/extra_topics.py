"""Publishing on the extra topics of rows, with a count of the messages that could not be published.

An extra topic has the payload of a row as a standard ROS 2 message, such as sensor_msgs/Imu (table key ``also``).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from roverlink.runtime.bridge.account import Account, ThrottledWarnings
from roverlink.runtime.core.handler import Stamps, all_to_cdr
from roverlink.runtime.core.registry import AnyStandardHandler
from roverlink.runtime.middleware import NOT_ACCEPTED, Publisher

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage


class ExtraTopics:
    """Publishers of all extra topics, the topics with a standard ROS 2 message for the payload of a row."""

    def __init__(self, account: Account, warnings: ThrottledWarnings) -> None:
        self._account, self._warnings = account, warnings
        self.publishers: dict[AnyStandardHandler, Publisher] = {}
        """Publisher of each extra topic, by its handler."""

    def open(self, handler: AnyStandardHandler, publisher: Publisher) -> None:
        """Store the publisher of an extra topic; ``handler`` converts payloads for this topic."""
        self.publishers[handler] = publisher

    def publish(self, batch: Iterable[tuple[AnyStandardHandler, Sequence[ProtoMessage]]], stamp: Stamps) -> None:
        """Convert and publish the payloads of a batch, with one call of the publisher for each topic.

        ``batch`` holds the handler of each extra topic with the payloads for the topic; ``stamp`` is the receive time,
        or tells that of measuring.

        If a topic has no subscribers, its payloads are neither converted nor counted, unless the topic's durability is
        transient_local.
        """
        for handler, payloads in batch:
            publisher = self.publishers[handler]
            # Most robots use few extra topics. An unused one must not cost each datagram a conversion.
            if publisher.has_subscribers() or handler.route.qos.durability == "transient_local":
                self._publish(handler, publisher, payloads, stamp)

    def _publish(
        self, handler: AnyStandardHandler, publisher: Publisher, payloads: Sequence[ProtoMessage], stamp: Stamps
    ) -> None:
        messages, misfits = all_to_cdr(handler, payloads, stamp)
        # A value that does not fit must not stop the row's own topic, so it is counted here and not raised.
        for error in misfits.values():
            self._missed(handler, 1, str(error))
        accepted = publisher.publish(messages) if messages else 0
        self._account.extra_published[handler.route.topic] += accepted
        if accepted < len(messages):
            self.not_accepted(handler, len(messages) - accepted)

    def not_accepted(self, handler: AnyStandardHandler, count: int) -> None:
        """Count messages of an extra topic that the middleware has not accepted, and log a warning."""
        self._missed(handler, count, f"{handler.route.topic}: {NOT_ACCEPTED}")

    def _missed(self, handler: AnyStandardHandler, count: int, why: str) -> None:
        """Count messages of an extra topic that were not published, and log a warning with the reason."""
        self._account.extra_unpublished[handler.route.topic] += count
        self._warnings.warn(f"unpublished {handler.route.topic}", f"not published: {why}")
