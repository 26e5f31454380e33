"""The ROS 2 side: middlewares that all speak serialized messages, so that one bridge serves each of them."""

from __future__ import annotations

import importlib
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from runtime.errors import MiddlewareError
from runtime.handler import Qos
from runtime.messages import Message

NAMES = ("auto", "dds", "rclpy", "memory")


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


def open_middleware(name: str, node: NodeIdentity, parameters: Mapping[str, Any] | None = None) -> Middleware:
    """Connect to ROS 2 by name; ``auto`` takes rclpy where it imports, else dds.

    ``parameters`` are shown as the node's own where the middleware can (rclpy). Raises `MiddlewareError` that says how
    to get what is missing.
    """
    if name == "auto":
        name = "rclpy" if _imports("rclpy") else "dds"
    if name == "memory":
        from runtime.middleware.memory import MemoryMiddleware

        return MemoryMiddleware()
    if name == "rclpy":
        return _open_rclpy(node, parameters or {})
    if name == "dds":
        return _open_dds(node)
    raise MiddlewareError(f"no middleware {name!r}; there are {', '.join(NAMES)}")


def _imports(package: str) -> bool:
    """Whether a package imports; one that was built for another Python is found, and does not."""
    try:
        importlib.import_module(package)
    except ImportError:
        return False
    return True


def _open_rclpy(node: NodeIdentity, parameters: Mapping[str, Any]) -> Middleware:
    try:
        from runtime.middleware.rclpy import RclpyMiddleware
    except ImportError as error:
        raise MiddlewareError(
            f"rclpy does not import ({error}); source ROS 2 first (`source /opt/ros/humble/setup.bash`), and make the "
            "environment with --system-site-packages"
        ) from error
    return RclpyMiddleware(node, parameters)


def _open_dds(node: NodeIdentity) -> Middleware:
    try:
        from runtime.middleware.dds import DdsMiddleware
    except ImportError as error:
        raise MiddlewareError(
            f"Cyclone DDS does not import ({error}); install it with `pip install cyclonedds`"
            + (
                f" (it has no wheel for {platform.machine()}: there, use --middleware rclpy with an installed ROS 2)"
                if platform.machine() not in ("x86_64", "AMD64")
                else ""
            )
        ) from error
    return DdsMiddleware(node)
