"""A middleware around the middleware: others hear what passes, and the bridge on top of it does not know."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.middleware.protocol import Callback, Middleware, Publisher, Subscription

Tap = Callable[[Sequence[bytes]], None]
"""Takes messages of one topic, oldest first, and returns at once."""


class Listener(Protocol):
    """Somebody who hears every topic: a recorder, a viewer."""

    def topic(self, topic: str, message_type: type[Message], qos: Qos) -> Tap:
        """Where to put the serialized messages of a topic; asked once for each, at start."""


class TappedMiddleware:
    """Another middleware, and a listener that hears what goes through it."""

    def __init__(self, middleware: Middleware, listener: Listener) -> None:
        self._middleware, self._listener = middleware, listener

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> Publisher:
        """A writer whose messages are heard once they are accepted."""
        return _TappedPublisher(
            self._middleware.publisher(topic, message_type, qos), self._listener.topic(topic, message_type, qos)
        )

    def subscribe(
        self, topic: str, message_type: type[Message], qos: Qos, callback: Callback, priority: int = 0
    ) -> Subscription:
        """A reader whose messages are heard before they are handled."""
        tap = self._listener.topic(topic, message_type, qos)

        def heard(messages: Sequence[bytes]) -> None:
            tap(messages)
            callback(messages)

        return self._middleware.subscribe(topic, message_type, qos, heard, priority)

    def close(self) -> None:
        """Take the node away."""
        self._middleware.close()

    def __enter__(self) -> TappedMiddleware:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class _TappedPublisher:
    def __init__(self, publisher: Publisher, tap: Tap) -> None:
        self._publish, self._tap = publisher.publish, tap

    def publish(self, messages: Sequence[bytes], /) -> int:
        """Write, and let hear what was accepted."""
        accepted = self._publish(messages)
        self._tap(messages if accepted == len(messages) else messages[:accepted])
        return accepted

    def has_subscribers(self) -> bool:
        """The listener does, whoever else."""
        return True
