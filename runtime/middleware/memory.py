"""A middleware inside one process: for tests, and where there is no ROS 2 at all."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field

from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.middleware.protocol import Callback

Callbacks = list[Callback]


@dataclass
class Graph:
    """The topics of one process, and who listens to each. Middlewares that share a graph see each other."""

    callbacks: defaultdict[str, Callbacks] = field(default_factory=lambda: defaultdict(list))
    publishers: Counter[str] = field(default_factory=Counter)


class MemoryPublisher:
    """Calls every subscriber of its topic at once, in the publishing thread."""

    def __init__(self, callbacks: Callbacks) -> None:
        self._callbacks = callbacks

    def publish(self, messages: Sequence[bytes], /) -> int:
        """Hand the messages to each subscriber."""
        for callback in tuple(self._callbacks):
            callback(messages)
        return len(messages)

    def has_subscribers(self) -> bool:
        """Whether anyone subscribed."""
        return bool(self._callbacks)


class MemorySubscription:
    """Knows who publishes on its topic."""

    def __init__(self, graph: Graph, topic: str) -> None:
        self._graph, self._topic = graph, topic

    def has_publishers(self) -> bool:
        """Whether any middleware that is open publishes."""
        return self._graph.publishers[self._topic] > 0


class MemoryMiddleware:
    """Topics within one process."""

    def __init__(self, graph: Graph | None = None) -> None:
        self._graph = graph if graph is not None else Graph()
        self._own: list[tuple[Callbacks, Callback]] = []
        self._published: list[str] = []

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> MemoryPublisher:
        """A writer on a topic."""
        self._published.append(topic)
        self._graph.publishers[topic] += 1
        return MemoryPublisher(self._graph.callbacks[topic])

    def subscribe(
        self, topic: str, message_type: type[Message], qos: Qos, callback: Callback, priority: int = 0
    ) -> MemorySubscription:
        """Call ``callback`` with the messages of a topic, from the thread that publishes them."""
        callbacks = self._graph.callbacks[topic]
        callbacks.append(callback)
        self._own.append((callbacks, callback))
        return MemorySubscription(self._graph, topic)

    def close(self) -> None:
        """Unsubscribe, and publish no more."""
        self._graph.publishers.subtract(self._published)
        self._published.clear()
        for callbacks, callback in self._own:
            callbacks.remove(callback)
        self._own.clear()

    def __enter__(self) -> MemoryMiddleware:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
