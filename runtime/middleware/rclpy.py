"""ROS 2 through an installed rclpy; messages are published and received in serialized form.

The generated interface package must be built (``colcon build``) and sourced, because rclpy finds the type support of a
message only through the class that rosidl generated for the message.
"""

from __future__ import annotations

import contextlib
import importlib
import logging
import threading
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions

from roverlink.runtime.core.errors import MiddlewareError
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message, how_to_install
from roverlink.runtime.middleware.protocol import Callback, NodeIdentity

if TYPE_CHECKING:
    from roverlink.runtime.middleware.rclpy_receiving import Receiver


class RclpyPublisher:
    """rclpy publisher for serialized messages."""

    def __init__(self, handle: Any) -> None:
        self._publish, self._count = handle.publish_raw, handle.get_subscription_count

    def publish(self, messages: Sequence[bytes], /) -> int:
        """Publish serialized messages."""
        for message in messages:
            self._publish(message)
        return len(messages)

    def has_subscribers(self) -> bool:
        """Return true if rclpy knows a subscription that matches this publisher."""
        return bool(self._count())


class RclpySubscription:
    """rclpy subscription of one topic."""

    def __init__(self, node: Any, topic: str) -> None:
        self._node, self._topic = node, topic

    def has_publishers(self) -> bool:
        """Return true if the ROS 2 graph has a publisher of the topic."""
        return bool(self._node.count_publishers(self._topic))


class RclpyMiddleware:
    """rclpy node with two threads: one takes the messages of its topics, and one spins the rest of the node."""

    def __init__(self, node: NodeIdentity, parameters: Mapping[str, Any]) -> None:
        # A context of its own: the default one may belong to a program that uses this package.
        self._context = rclpy.Context()
        # Signals, remappings and parameters stay with our command line, which has handled them already.
        rclpy.init(args=[], context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self._node = rclpy.create_node(
            node.name, namespace=node.namespace, context=self._context, use_global_arguments=False
        )
        for name, value in parameters.items():
            self._node.declare_parameter(name, value)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._receiver = _receiver(self._node)
        self._held = contextlib.ExitStack()
        self._open = True
        self._thread = threading.Thread(target=self._spin, name="rclpy-spin", daemon=True)
        self._thread.start()

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> RclpyPublisher:
        """Create a publisher on a fully qualified topic."""
        publisher = self._node.create_publisher(_ros_class(message_type), topic, _profile(qos))
        # rclpy's own `publish` enters the handle for each message, so that nobody destroys the publisher meanwhile.
        # To enter it once, and to publish by the handle, saves half of what a message costs.
        self._held.enter_context(publisher.handle)
        return RclpyPublisher(publisher.handle)

    def subscribe(
        self, topic: str, message_type: type[Message], qos: Qos, callback: Callback, priority: int = 0
    ) -> RclpySubscription:
        """Call ``callback`` with the serialized messages of a fully qualified topic, on a thread of the middleware."""
        message_class, profile = _ros_class(message_type), _profile(qos)
        if self._receiver:
            self._receiver.subscribe(message_class, topic, profile, callback, priority)
        else:
            # raw=True gives serialized messages, so rclpy does not build Python objects that nobody needs.
            self._node.create_subscription(message_class, topic, lambda message: callback([message]), profile, raw=True)
        return RclpySubscription(self._node, topic)

    def close(self) -> None:
        """Stop spinning and destroy the node."""
        if not self._open:
            return
        self._open = False
        if self._receiver:
            self._receiver.stop()
        # First the thread, then the node: an executor that waits for what is destroyed may raise InvalidHandle.
        self._executor.shutdown()
        self._thread.join()
        self._held.close()
        self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def __enter__(self) -> RclpyMiddleware:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _spin(self) -> None:
        # Somebody else in the process may shut ROS 2 down; the program ends by its own signal handler.
        with contextlib.suppress(ExternalShutdownException):
            self._executor.spin()


def _receiver(node: Any) -> Receiver | None:
    """Start the thread that takes messages; None if this rclpy lacks what the thread needs."""
    try:
        # Imported here, because the module uses internal names of rclpy.
        from roverlink.runtime.middleware.rclpy_receiving import Receiver

        return Receiver(node)
    except (ImportError, AttributeError, TypeError) as error:
        logging.getLogger("roverlink").warning(
            "this version of rclpy is unknown (%s), so its executor receives the messages, which needs more CPU", error
        )
        return None


def _ros_class(message_type: type[Message]) -> Any:
    """Return the class that rosidl generated for a message, from the installed interface package."""
    package, _, name = message_type.__msgtype__.split("/")
    try:
        return getattr(importlib.import_module(f"{package}.msg"), name)
    except (ImportError, AttributeError) as error:
        raise MiddlewareError(
            f"the interface {message_type.__msgtype__} is not installed ({error}); {how_to_install(message_type)}"
        ) from error


def _profile(qos: Qos) -> QoSProfile:
    return QoSProfile(
        reliability=ReliabilityPolicy[qos.reliability.upper()],
        durability=DurabilityPolicy[qos.durability.upper()],
        history=HistoryPolicy[qos.history.upper()],
        depth=qos.depth,
    )
