"""Topics on which results are published, if somebody listens."""

from __future__ import annotations

from collections.abc import Callable

from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import MiddlewareError
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.middleware import Middleware, Publisher

LATEST = Qos(depth=5)
"""Quality of service for images: the depth of ROS 2's profile for sensor data."""


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

    def open(self, name: str, message_type: type[Message], qos: Qos = Qos()) -> Output:  # noqa: B008  # it is frozen
        """Open a topic."""
        topic = self._topic(name)
        try:
            return Output(self._middleware.publisher(topic, message_type, qos))
        except MiddlewareError as error:
            self._say(f"cannot publish on {topic}: {error}")
            return Output(None)
