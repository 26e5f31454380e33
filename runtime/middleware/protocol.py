"""Interface that every middleware has. A middleware exchanges serialized messages with the ROS 2 graph."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeVar, runtime_checkable

from roverlink.runtime.core.handler import Qos, RowService
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces.rcl_interfaces import ParameterDescriptor

M = TypeVar("M", bound="Middleware")

NOT_ACCEPTED = "a subscriber is too slow, or ROS 2 cannot publish it"
"""Reason why a publisher did not accept a message, for the user."""

Callback = Callable[[Sequence[bytes]], None]
"""Function called with all messages of one topic that have arrived, serialized (CDR with header), oldest first."""


@dataclass(frozen=True, slots=True)
class NodeIdentity:
    """Name and namespace of the program's ROS 2 node."""

    name: str
    namespace: str = "/"
    """Namespace with a leading slash."""

    def topic(self, name: str) -> str:
        """Return the fully qualified name of a topic.

        For a node ``/rover/bridge``, ``imu`` becomes ``/rover/imu``, ``~/imu`` becomes ``/rover/bridge/imu``, and
        ``/imu`` is unchanged.
        """
        if name.startswith("/"):
            return name
        if name.startswith("~/"):
            return f"{self.full_name}/{name[2:]}"
        return f"{self.namespace.rstrip('/')}/{name}"

    @property
    def full_name(self) -> str:
        """Namespace and name of the node, as ``ros2 node list`` prints them."""
        return f"{self.namespace.rstrip('/')}/{self.name}"


class NodeParameters(Protocol):
    """Parameters of the program's node, which ROS 2 tools may read and change. Safe to use from several threads."""

    @property
    def values(self) -> Mapping[str, Any]:
        """Value of each parameter by its name."""

    @property
    def descriptors(self) -> Mapping[str, ParameterDescriptor]:
        """Declaration of each parameter by its name: type, description, and allowed values."""

    def change(self, changes: Mapping[str, Any]) -> None:
        """Change parameters and apply the changes.

        Raises `SetupError` with the reason if one of them cannot change; then none has changed.
        """


@dataclass(frozen=True, slots=True)
class Endpoint:
    """Publisher or subscription of a topic, as the ROS 2 graph shows it."""

    node: str
    """Full name of the node; empty if the name is not known yet."""
    qos: Qos
    """Reliability and durability; the graph does not show history and depth."""
    demands: tuple[str, ...] = ()
    """Further QoS policies that a subscription requires, and that no publisher of roverlink offers: ``deadline``."""
    type: str = field(default="", compare=False)
    """Type of the messages, as in ``sensor_msgs/msg/Image``; empty if the name is none of ROS 2."""


class Publisher(Protocol):
    """Publisher on one topic."""

    def publish(self, messages: Sequence[bytes], /) -> int:
        """Publish serialized messages (CDR with header) in order, without ever waiting for a subscriber.

        Returns how many messages were accepted. If the queue is full, or publishing fails, the remaining messages are
        not accepted, and the caller counts them as lost. Raises no error.
        """

    def has_subscribers(self) -> bool:
        """Return true if the middleware knows a subscriber of the topic."""


class Subscription(Protocol):
    """Subscription of one topic."""

    def has_publishers(self) -> bool:
        """Return true if the middleware knows a publisher of the topic.

        A publisher whose program was killed is known for some more seconds.
        """

    def close(self) -> None:
        """End the subscription. The callback may still be called for messages that have just been taken."""


@runtime_checkable
class WatchedSubscription(Protocol):
    """Subscription that tells when its publishers have left, so that nobody has to ask again and again."""

    def watch(self, left: Callable[[], None]) -> None:
        """Call ``left`` when the last publisher has left, on a thread of the middleware, which must not wait."""


Respond = Callable[[bytes], None]
"""Function that sends the serialized response to one request of a service. Must be called once, on any thread."""


class ServiceClient(Protocol):
    """Client of one service."""

    def call(self, request: bytes, done: Respond) -> bool:
        """Send a serialized request, and call ``done`` with the serialized response, on a thread of the middleware.

        Returns false if no node is known that offers the service; ``done`` is not called then. Never waits. If the
        node does not answer, ``done`` is never called.
        """


class Middleware(Protocol):
    """Connection to the ROS 2 graph as one node. A context manager: on exit the node leaves the graph."""

    passes_any_qos: bool = False
    """True if messages pass between a publisher and a subscription whose QoS does not match, as over zenoh."""

    # Some middlewares need the argument.
    def check_types(self, message_types: Iterable[type[Message]]) -> None:  # noqa: ARG002
        """Raise `MiddlewareError` if ROS 2 lacks a message type, or has one with other fields.

        A middleware that needs no interface packages accepts all message types.
        """
        return  # mypy takes a method without a body for an abstract one

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> Publisher:
        """Create a publisher for a fully qualified topic."""

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
        """Call ``callback`` with serialized messages of a fully qualified topic, on a thread of the middleware.

        If the middleware supports priorities, topics with a larger ``priority`` are served first. A middleware may keep
        more messages than the depth of the QoS until it can call ``callback``; ``exact_depth`` forbids this, so that
        large messages such as images do not fill the memory.

        A link may hold messages back, and deliver all of them later. With ``late``, a message that comes more than a
        second late is not delivered, and ``late`` is called instead, so that nobody obeys an old command. This needs a
        middleware that can tell, as zenoh, and a topic that is volatile.
        """

    def offer(self, name: str, service: RowService, answer: Callable[[bytes, Respond], None]) -> None:
        """Offer a service with a fully qualified name, until the node leaves the graph.

        ``answer`` is called with each serialized request, on a thread of the middleware, and must not wait: it, or
        something else later, calls the function that it gets with the response.
        """
        raise NotImplementedError

    def client(self, name: str, service: RowService) -> ServiceClient:
        """Create a client of the service with a fully qualified name."""
        raise NotImplementedError

    def topics(self) -> Mapping[str, str]:
        """Return the fully qualified topics with publishers that the middleware knows now, each with its message type.

        A type is given as in ``sensor_msgs/msg/Image``. Must be called by one thread at a time.
        """

    def endpoints(self, topic: str, publishing: bool) -> Sequence[Endpoint]:
        """Return the publishers or subscriptions of a fully qualified topic that the middleware knows now.

        ``publishing`` selects: true for publishers, false for subscriptions. Must be called by one thread at a time.
        """

    def address_changes(self) -> str:
        """Return a text about addresses that have changed since the node joined ROS 2; empty if none have."""
        return ""

    def set_parameters(self, changes: Mapping[str, Any]) -> None:
        """Change parameters of the own node, as `ros2 param set` does; the node must have parameters.

        Raises `SetupError` with the reason if one of them cannot change; then none has changed.
        """

    def close(self) -> None:
        """Make the node leave the ROS 2 graph. A second call does nothing."""

    def __enter__(self: M) -> M:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
