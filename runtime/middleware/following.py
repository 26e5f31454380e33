"""Subscription that follows the publishers of its topic: their message type, and their QoS.

DDS passes no messages between a publisher and a subscription whose QoS does not match. A program that reads the topic
of any other node, such as a camera driver, therefore has to take over the QoS of that node.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence

from roverlink.runtime.core.errors import MiddlewareError
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.middleware.protocol import Endpoint, Middleware, Subscription

TypedCallback = Callable[[type[Message], Sequence[bytes]], None]
"""Function called with a message type, and with serialized messages of this type, oldest first."""


def matching_qos(publishers: Sequence[Endpoint], depth: int, best_effort: bool = False) -> Qos:
    """Return the QoS of a subscription that all publishers match. It is as strict as the publishers allow.

    With ``best_effort``, the subscription is never reliable. Without publishers, the QoS is ROS 2's default.
    """
    reliable = not best_effort and all(endpoint.qos.reliability == "reliable" for endpoint in publishers)
    latched = bool(publishers) and all(endpoint.qos.durability == "transient_local" for endpoint in publishers)
    return Qos(
        "reliable" if reliable else "best_effort",
        "transient_local" if latched else "volatile",
        depth=depth,
    )


class FollowingSubscription:
    """Subscription of a topic, with the message type and a matching QoS of its publishers.

    It begins when the first publisher is known. If another publisher needs another QoS or has another type, the
    subscription is replaced.
    """

    def __init__(
        self,
        middleware: Middleware,
        topic: str,
        message_types: Sequence[type[Message]],
        callback: TypedCallback,
        depth: int,
    ) -> None:
        """Prepare the subscription; `look` makes it. One of ``message_types`` must be the type of the topic."""
        self._middleware, self._topic, self._callback, self._depth = middleware, topic, callback, depth
        self._types = {message_type.__msgtype__: message_type for message_type in message_types}
        self._made: tuple[str, Qos] | None = None
        self._subscription: Subscription | None = None
        self._lock = threading.Lock()  # a subscription must not be made while another thread closes this object
        self._closed = False

    def look(self) -> bool:
        """Subscribe if the publishers need a new subscription; return false if no publisher is known.

        Call this again and again while no message comes. Raises `MiddlewareError` if the topic has another message
        type than the possible ones, or if the middleware lacks the type.
        """
        with self._lock:
            name = None if self._closed else self._middleware.topics().get(self._topic)
            if name is None:
                return False
            self._follow(name)
            return True

    def close(self) -> None:
        """End the subscription. Afterwards, `look` does nothing."""
        with self._lock:
            self._closed = True
            self._end()

    def _follow(self, name: str) -> None:
        """Subscribe with the message type of this name and the QoS of the publishers, unless this is done already."""
        message_type = self._types.get(name)
        if message_type is None:
            raise MiddlewareError(
                f"{self._topic} has messages of the type {name}; a topic with {' or '.join(self._types)} is needed"
            )
        publishers = self._middleware.endpoints(self._topic, True)
        wanted = name, matching_qos(publishers, self._depth)
        if wanted != self._made:
            self._end()
            self._subscription = self._middleware.subscribe(
                self._topic,
                message_type,
                wanted[1],
                lambda messages: self._callback(message_type, messages),
                exact_depth=True,
            )
            self._made = wanted

    def _end(self) -> None:
        if self._subscription is not None:
            self._subscription.close()
            self._subscription = self._made = None
