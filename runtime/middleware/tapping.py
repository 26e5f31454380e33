"""Middleware wrapper that passes a copy of every message to a listener, such as a recorder.

The bridge uses the wrapper like any other middleware.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Protocol

from roverlink.runtime.core.handler import Qos, RowService
from roverlink.runtime.core.messages import Message
from roverlink.runtime.core.tap import Tap
from roverlink.runtime.middleware.protocol import (
    Callback,
    Endpoint,
    Middleware,
    Publisher,
    Respond,
    ServiceClient,
    Subscription,
    WatchedSubscription,
)
from roverlink.runtime.native import bridge_layout as native
from roverlink.runtime.native.core import NativeCore
from roverlink.runtime.native.lending import LentTopic, NativePublisher, NativeSubscription


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
        self.passes_any_qos = middleware.passes_any_qos

    def check_types(self, message_types: Iterable[type[Message]]) -> None:
        """Let the wrapped middleware check the message types."""
        self._middleware.check_types(message_types)

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> Publisher:
        """Create a publisher that passes the messages it has published to the listener."""
        publisher = self._middleware.publisher(topic, message_type, qos)
        tap = self._listener.topic(topic, message_type, qos)
        if tap is None:
            return publisher
        return (_LentPublisher if isinstance(publisher, NativePublisher) else _TappedPublisher)(publisher, tap)

    def subscribe(
        self,
        topic: str,
        message_type: type[Message],
        qos: Qos,
        callback: Callback,
        priority: int = 0,
        exact_depth: bool = False,
        late: Callable[[], None] | None = None,
    ) -> Subscription:
        """Subscribe to a topic. The listener gets each message before the callback gets it."""
        tap = self._listener.topic(topic, message_type, qos)
        if tap is None:
            return self._middleware.subscribe(topic, message_type, qos, callback, priority, exact_depth, late)

        def tapped(messages: Sequence[bytes]) -> None:
            tap(messages)
            callback(messages)

        subscription = self._middleware.subscribe(topic, message_type, qos, tapped, priority, exact_depth, late)
        return _LentSubscription(subscription, tap) if isinstance(subscription, NativeSubscription) else subscription

    def offer(self, name: str, service: RowService, answer: Callable[[bytes, Respond], None]) -> None:
        """Offer a service through the wrapped middleware; the listener does not see what is asked."""
        self._middleware.offer(name, service, answer)

    def client(self, name: str, service: RowService) -> ServiceClient:
        """Create a client of a service through the wrapped middleware."""
        return self._middleware.client(name, service)

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


class _LentSubscription:
    def __init__(self, subscription: NativeSubscription, tap: Tap) -> None:
        self._subscription, self._tap = subscription, tap
        self.has_publishers, self.close = subscription.has_publishers, subscription.close
        if isinstance(subscription, WatchedSubscription):
            self.watch = subscription.watch

    def lend_to(self, core: NativeCore, lent: LentTopic) -> None:
        """Let the core take the messages, and pass a copy of each to the listener."""
        self._subscription.lend_to(core, lent._replace(taps=(*lent.taps, self._tap)))


class _TappedPublisher:
    def __init__(self, publisher: Publisher, tap: Tap) -> None:
        self._publisher: Any = publisher
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


class _LentPublisher(_TappedPublisher):
    def lend_to(self, topic: native.Topic, functions: native.MiddlewareFunctions) -> Sequence[Tap]:
        """Let the core publish, and pass a copy of each message to the listener."""
        return [*self._publisher.lend_to(topic, functions), self._tap]
