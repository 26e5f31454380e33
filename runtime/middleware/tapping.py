"""Middleware wrapper that passes a copy of every message to a listener, such as a recorder.

The bridge uses the wrapper like any other middleware.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Protocol

from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.middleware.protocol import Callback, Endpoint, Middleware, Publisher, Subscription

Tap = Callable[[Sequence[bytes]], None]
"""Function that takes messages of one topic, oldest first. It must return at once."""


class Listener(Protocol):
    """Listener to the messages of all topics of a middleware, such as a recorder or a viewer."""

    def topic(self, topic: str, message_type: type[Message], qos: Qos) -> Tap | None:
        """Return a function that takes the serialized messages of a topic; None to leave the topic alone.

        The wrapper calls this once for each topic, when the topic is opened.
        """


class TappedMiddleware(Middleware):
    """Wrapper of a middleware that also passes every published or received message to a listener."""

    def __init__(self, middleware: Middleware, listener: Listener) -> None:
        self._middleware, self._listener = middleware, listener

    def check_types(self, message_types: Iterable[type[Message]]) -> None:
        """Let the wrapped middleware check the message types."""
        self._middleware.check_types(message_types)

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> Publisher:
        """Create a publisher that passes the messages it has published to the listener."""
        publisher = self._middleware.publisher(topic, message_type, qos)
        tap = self._listener.topic(topic, message_type, qos)
        return publisher if tap is None else _TappedPublisher(publisher, tap)

    def subscribe(
        self,
        topic: str,
        message_type: type[Message],
        qos: Qos,
        callback: Callback,
        priority: int = 0,
        exact_depth: bool = False,
    ) -> Subscription:
        """Subscribe to a topic. The listener gets each message before the callback gets it."""
        tap = self._listener.topic(topic, message_type, qos)
        if tap is None:
            return self._middleware.subscribe(topic, message_type, qos, callback, priority, exact_depth)

        def tapped(messages: Sequence[bytes]) -> None:
            tap(messages)
            callback(messages)

        return self._middleware.subscribe(topic, message_type, qos, tapped, priority, exact_depth)

    def endpoints(self, topic: str, publishing: bool) -> Sequence[Endpoint]:
        """Return the publishers or the subscriptions of a topic that the wrapped middleware knows."""
        return self._middleware.endpoints(topic, publishing)

    def topics(self) -> Mapping[str, str]:
        """Return the topics with publishers that the wrapped middleware knows, each with its message type."""
        return self._middleware.topics()

    def address_changes(self) -> str:
        """Return what the wrapped middleware tells about addresses that have changed."""
        return self._middleware.address_changes()

    def set_parameters(self, changes: Mapping[str, Any]) -> None:
        """Let the wrapped middleware change parameters of the own node."""
        self._middleware.set_parameters(changes)

    def close(self) -> None:
        """Close the wrapped middleware, so that the node leaves the ROS 2 graph."""
        self._middleware.close()


class _TappedPublisher:
    def __init__(self, publisher: Publisher, tap: Tap) -> None:
        self._publish, self._tap = publisher.publish, tap

    def publish(self, messages: Sequence[bytes], /) -> int:
        """Publish messages; pass those that the middleware accepted to the listener."""
        # A message that no subscriber could get has not crossed the bridge, so it is not recorded either.
        accepted = self._publish(messages)
        self._tap(messages if accepted == len(messages) else messages[:accepted])
        return accepted

    def has_subscribers(self) -> bool:
        """Return true, because the listener counts as a subscriber."""
        return True
