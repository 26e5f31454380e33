"""Topics on which results are published, if somebody listens."""

from __future__ import annotations

from collections.abc import Callable

from roverlink.nodes import Topic
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import MiddlewareError
from roverlink.runtime.core.messages import Message
from roverlink.runtime.middleware import Middleware, Publisher


class Output:
    """Topic with its publisher; without one, if the topic cannot be published, messages are dropped."""

    def __init__(self, publisher: Publisher | None) -> None:
        self._publisher = publisher

    def put(self, make: Callable[[], Message]) -> None:
        """Call `make` and publish the message that it returns, but only if the topic has a subscriber."""
        if self._publisher is not None and self._publisher.has_subscribers():
            self.publish(make())

    def publish(self, message: Message) -> None:
        """Publish a message in any case: on a topic that keeps it for later subscribers."""
        if self._publisher is not None:
            self._publisher.publish([cdr.encode(message)])


class Outputs:
    """Opens outputs of one node."""

    def __init__(self, middleware: Middleware, topic: Callable[[str], str], say: Callable[[str], None]) -> None:
        """Prepare; `topic` returns the fully qualified name of a topic.

        `say` is called with a message if a topic cannot be published, for instance if rclpy lacks the message type.
        """
        self._middleware, self._topic, self._say = middleware, topic, say

    def open(self, topic: Topic) -> Output:
        """Open a topic."""
        try:
            return Output(topic.publisher(self._middleware, self._topic))
        except MiddlewareError as error:
            self._say(f"cannot publish on {self._topic(topic.name)}: {error}")
            return Output(None)
