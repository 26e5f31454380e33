"""Middleware that passes messages inside one process, for tests and for machines without ROS 2."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from roverlink.runtime.core.handler import Qos, RowService
from roverlink.runtime.core.messages import Message
from roverlink.runtime.middleware.protocol import Callback, Endpoint, Middleware, NodeParameters, Respond

Callbacks = list[Callback]
Answer = Callable[[bytes, Respond], None]


@dataclass
class Graph:
    """Topics inside one process, with their subscribers and publishers.

    Middlewares with the same `Graph` are connected.
    """

    callbacks: defaultdict[str, Callbacks] = field(default_factory=lambda: defaultdict(list))
    publishers: Counter[str] = field(default_factory=Counter)
    types: dict[str, str] = field(default_factory=dict)
    services: dict[str, Answer] = field(default_factory=dict)


class MemoryPublisher:
    """Publisher that calls the callbacks of all subscribers of its topic directly, on the publishing thread."""

    def __init__(self, callbacks: Callbacks) -> None:
        self._callbacks = callbacks

    def publish(self, messages: Sequence[bytes], /) -> int:
        """Pass the messages to each subscriber; return their number, because all messages are accepted."""
        # A copy: a callback may subscribe or unsubscribe.
        for callback in tuple(self._callbacks):
            callback(messages)
        return len(messages)

    def has_subscribers(self) -> bool:
        """Return true if the topic has a subscriber."""
        return bool(self._callbacks)


class MemorySubscription:
    """Subscription of one topic in a `Graph`."""

    def __init__(self, graph: Graph, topic: str, close: Callable[[], None]) -> None:
        self._graph, self._topic, self._close = graph, topic, close

    def has_publishers(self) -> bool:
        """Return true if the topic has a publisher whose middleware is not closed."""
        return self._graph.publishers[self._topic] > 0

    def close(self) -> None:
        """Remove the callback from the graph."""
        self._close()


class MemoryClient:
    """Client that calls the function of a service directly."""

    def __init__(self, graph: Graph, name: str) -> None:
        self._services, self._name = graph.services, name

    def call(self, request: bytes, done: Respond) -> bool:
        """Call the service's function; return false if no middleware offers the service."""
        if (answer := self._services.get(self._name)) is not None:
            answer(request, done)
        return answer is not None


class MemoryMiddleware(Middleware):
    """Middleware for the topics of a `Graph`."""

    def __init__(self, graph: Graph | None = None, parameters: NodeParameters | None = None) -> None:
        self._graph = graph if graph is not None else Graph()
        self._parameters = parameters
        self._own: list[tuple[Callbacks, Callback]] = []
        self._published: list[str] = []

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> MemoryPublisher:
        """Create a publisher on a topic of the graph."""
        self._published.append(topic)
        self._graph.publishers[topic] += 1
        self._graph.types[topic] = message_type.__msgtype__
        return MemoryPublisher(self._graph.callbacks[topic])

    def subscribe(
        self,
        topic: str,
        message_type: type[Message],
        qos: Qos,
        callback: Callback,
        priority: int = 0,
        exact_depth: bool = False,
        late: Callable[[], None] | None = None,
    ) -> MemorySubscription:
        """Call ``callback`` with the messages of a topic, on the thread that publishes them."""
        callbacks = self._graph.callbacks[topic]
        callbacks.append(callback)
        own = (callbacks, callback)
        self._own.append(own)

        def close() -> None:
            if own in self._own:  # closing the middleware has removed it already
                self._own.remove(own)
                callbacks.remove(callback)

        return MemorySubscription(self._graph, topic, close)

    def offer(self, name: str, service: RowService, answer: Answer) -> None:
        """Offer a service; ``answer`` is called on the thread that calls the service."""
        self._graph.services[name] = answer

    def client(self, name: str, service: RowService) -> MemoryClient:
        """Create a client of a service of the graph."""
        return MemoryClient(self._graph, name)

    def endpoints(self, topic: str, publishing: bool) -> tuple[Endpoint, ...]:
        """Return an empty tuple, because topics in memory have no QoS."""
        return ()

    def topics(self) -> Mapping[str, str]:
        """Return the topics of the graph that have publishers, each with its message type."""
        return {topic: self._graph.types[topic] for topic, count in self._graph.publishers.items() if count > 0}

    def set_parameters(self, changes: Mapping[str, Any]) -> None:
        """Change parameters of the own node."""
        if self._parameters is not None:
            self._parameters.change(changes)

    def close(self) -> None:
        """Remove the subscriptions and publishers of this middleware from the graph."""
        self._graph.publishers.subtract(self._published)
        self._published.clear()
        for callbacks, callback in self._own:
            callbacks.remove(callback)
        self._own.clear()
