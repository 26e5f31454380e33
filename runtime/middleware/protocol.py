"""The middleware: a connection to the ROS 2 graph that speaks serialized messages, whichever way it reaches it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message

Callback = Callable[[Sequence[bytes]], None]
"""What is called with serialized messages (CDR with its header) of one topic, oldest first: as many as have come."""


@dataclass(frozen=True, slots=True)
class NodeIdentity:
    """Who we are on the ROS 2 graph."""

    name: str
    namespace: str = "/"
    """Fully qualified, starting with a slash."""

    def topic(self, name: str) -> str:
        """The fully qualified name of a topic: ``~/x`` is below the node, ``x`` in its namespace."""
        if name.startswith("/"):
            return name
        if name.startswith("~/"):
            return f"{self.full_name}/{name[2:]}"
        return f"{self.namespace.rstrip('/')}/{name}"

    @property
    def full_name(self) -> str:
        """Namespace and name, as ``ros2 node list`` prints it."""
        return f"{self.namespace.rstrip('/')}/{self.name}"


class Publisher(Protocol):
    """One topic to write to."""

    def publish(self, messages: Sequence[bytes], /) -> int:
        """Write serialized messages (CDR with its header), in order. Never waits for a subscriber.

        Returns how many were accepted; the others would have had to wait.
        """

    def has_subscribers(self) -> bool:
        """Whether anyone is known to listen."""


class Subscription(Protocol):
    """One topic to read from."""

    def has_publishers(self) -> bool:
        """Whether anyone is known to publish. A publisher that was killed is known for some seconds more."""


class Middleware(Protocol):
    """A connection to the ROS 2 graph, as one node. A context manager: leaving it takes the node away."""

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> Publisher:
        """A writer on a fully qualified topic."""

    def subscribe(
        self, topic: str, message_type: type[Message], qos: Qos, callback: Callback, priority: int = 0
    ) -> Subscription:
        """Call ``callback`` with the serialized messages of a fully qualified topic, from a thread of ours.

        Topics of a larger ``priority`` are served before others, where the middleware lets us decide that.
        """

    def close(self) -> None:
        """Take the node away. More than once does no harm."""

    def __enter__(self) -> Middleware: ...

    def __exit__(self, *_: object) -> None: ...
