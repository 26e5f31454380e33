"""Simulated ROS 2 nodes of the rover, which command its boards through a bridge."""

from __future__ import annotations

from collections.abc import Collection

from roverlink import topic_types
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import Registry
from roverlink.runtime.middleware import Middleware


class SimulatedNodes:
    """Publishers of the topics whose messages a bridge sends to peers."""

    def __init__(self, registry: Registry, middleware: Middleware, without: Collection[str] = ()) -> None:
        """Create a publisher for each row that goes to a peer, except for the rows named ``without``."""
        self._publishers = [
            (
                handler,
                middleware.publisher(
                    topic_types.full_topic(handler.route.topic), handler.message_type, handler.route.qos
                ),
            )
            for handler in registry.handlers
            if not handler.route.inbound and handler.route.name not in without
        ]

    def are_heard(self) -> bool:
        """Return true if each topic has a subscriber."""
        return all(publisher.has_subscribers() for _, publisher in self._publishers)

    def publish(self, seconds: float) -> int:
        """Publish the values of the time ``seconds`` after the start on each topic that has a subscriber.

        Return the number of published messages.
        """
        return sum(
            publisher.publish([handler.to_cdr(payload_at(handler.payload_type, seconds))])
            for handler, publisher in self._publishers
            if publisher.has_subscribers()
        )
