"""ROS 2 through an installed rclpy; messages are published and received in serialized form.

The generated interface package must be built (``colcon build``) and sourced, because rclpy finds the type support of a
message only through the class that rosidl generated for the message.
"""

from __future__ import annotations

import contextlib
import ctypes
import logging
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

import rclpy
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from rclpy.signals import SignalHandlerOptions

from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.handler import Qos, RowService
from roverlink.runtime.core.messages import Message
from roverlink.runtime.core.tap import Tap
from roverlink.runtime.middleware.interface_packages import installed_class
from roverlink.runtime.middleware.joined_addresses import JoinedAddresses
from roverlink.runtime.middleware.protocol import (
    Callback,
    Endpoint,
    Middleware,
    NodeIdentity,
    NodeParameters,
    Respond,
    ServiceClient,
)
from roverlink.runtime.middleware.rcl_loop import rcl_function
from roverlink.runtime.middleware.ros_domain import ros_domain
from roverlink.runtime.middleware.serving import has_ended
from roverlink.runtime.native import bridge_layout as native

if TYPE_CHECKING:
    from roverlink.runtime.middleware.rclpy_actions import RclpyAction
    from roverlink.runtime.middleware.rclpy_receiving import Receiver, Subscribed

T = TypeVar("T")

# Names that the ROS 2 middlewares give to the node of an endpoint until they know it.
_UNKNOWN_NODES = ("_NODE_NAME_UNKNOWN_", "_CREATED_BY_BARE_DDS_APP_")
_USE_SIM_TIME = "use_sim_time"  # which rclpy declares itself
_MAKING_S = 60.0  # longest time in seconds for the executor to make a client or a service, far more than it takes
# Longest wait of the executor in seconds: a shutdown from outside can miss an executor that is just about to wait.
_SPIN_S = 1.0
_INFINITE_NS = 2**63 - 1  # RMW_DURATION_INFINITE
# A writer whose queue is full waits for a subscriber, up to 0.1 s, before it refuses a message, and rclpy cannot change
# that. After such a wait the publisher accepts nothing for some time, so that a frozen subscriber costs the other
# topics at most a tenth of the time.
_PAUSE = 9  # times as long as the wait


class RclpyPublisher:
    """rclpy publisher for serialized messages."""

    def __init__(self, handle: Any) -> None:
        self._handle, self._publish, self._count = handle, handle.publish_raw, handle.get_subscription_count
        self._paused_until = 0.0

    def publish(self, messages: Sequence[bytes], /) -> int:
        """Publish serialized messages; return how many were accepted."""
        began = time.monotonic()
        if began < self._paused_until:
            return 0
        accepted = 0
        try:
            for message in messages:
                self._publish(message)
                accepted += 1
        except RuntimeError:  # RCLError, which only a private module of rclpy has
            now = time.monotonic()
            self._paused_until = now + _PAUSE * (now - began)
        return accepted

    def lend_to(self, topic: native.Topic, functions: native.MiddlewareFunctions) -> Sequence[Tap]:
        """Let the native core publish through this publisher (see `NativePublisher`)."""
        topic.publisher = self._handle.pointer
        functions.publish = ctypes.cast(rcl_function("rcl_publish_serialized_message"), ctypes.c_void_p)
        count = rcl_function("rcl_publisher_get_subscription_count")
        functions.count_subscriptions = ctypes.cast(count, ctypes.c_void_p)
        return ()

    def has_subscribers(self) -> bool:
        """Return true if rclpy knows a subscription that matches this publisher."""
        return bool(self._count())


class RclpySubscription:
    """rclpy subscription of one topic."""

    def __init__(self, node: Any, topic: str, close: Callable[[], None]) -> None:
        self._node, self._topic = node, topic
        self.close = close

    def has_publishers(self) -> bool:
        """Return true if the ROS 2 graph has a publisher of the topic."""
        return bool(self._node.count_publishers(self._topic))


class _LentSubscription(RclpySubscription):
    """The same for a subscription whose messages the native core can take."""

    def __init__(self, node: Any, topic: str, subscribed: Subscribed) -> None:
        super().__init__(node, topic, subscribed.close)
        self.lend_to = subscribed.lend_to


class RclpyMiddleware(Middleware):
    """rclpy node with two threads: one takes the messages of its topics, and one spins the executor for all else."""

    def __init__(self, node: NodeIdentity, parameters: NodeParameters | None) -> None:
        ros_domain()  # rclpy would end with a traceback for a wrong one
        # A context of its own: the default one may belong to a program that uses this package.
        self._context = rclpy.Context()
        # Signals, remappings and parameters stay with our command line, which has handled them already.
        rclpy.init(args=[], context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        simulated = parameters is not None and parameters.values.get(_USE_SIM_TIME)
        self._joined_addresses = JoinedAddresses()
        self._node = rclpy.create_node(
            node.name,
            namespace=node.namespace,
            context=self._context,
            use_global_arguments=False,
            parameter_overrides=[Parameter(_USE_SIM_TIME, value=True)] if simulated else None,
        )
        if parameters is not None:
            self._declare(parameters)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._receiver = _receiver(self._node)
        self._held = contextlib.ExitStack()
        self._open = True
        self._thread = threading.Thread(target=self._spin, name="rclpy-spin", daemon=True)
        self._thread.start()

    def _declare(self, parameters: NodeParameters) -> None:
        for name, value in parameters.values.items():
            if name != _USE_SIM_TIME:
                descriptor = deserialize_message(cdr.encode(parameters.descriptors[name]), ParameterDescriptor)
                self._node.declare_parameter(name, value, descriptor)

        def change(changes: Sequence[Any]) -> Any:
            try:
                parameters.change({parameter.name: parameter.value for parameter in changes})
            except SetupError as error:
                return SetParametersResult(successful=False, reason=str(error))
            return SetParametersResult(successful=True)

        # Humble has no callback after a change. This one is the last that can refuse a change of these parameters, so
        # rclpy stores everything that it applies.
        self._node.add_on_set_parameters_callback(change)

    def check_types(self, message_types: Iterable[type[Message]]) -> None:
        """Raise `MiddlewareError` if the installed interface packages lack a message type, or have other fields."""
        for message_type in message_types:
            installed_class(message_type)

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> RclpyPublisher:
        """Create a publisher for serialized messages on a fully qualified topic."""
        publisher = self._node.create_publisher(installed_class(message_type), topic, _profile(qos))
        # rclpy's own `publish` enters the handle for each message, so that nobody destroys the publisher meanwhile.
        # To enter it once, and to publish by the handle, saves half of what a message costs.
        self._held.enter_context(publisher.handle)
        return RclpyPublisher(publisher.handle)

    def subscribe(
        self,
        topic: str,
        message_type: type[Message],
        qos: Qos,
        callback: Callback,
        priority: int = 0,
        exact_depth: bool = False,  # noqa: ARG002  # rclpy never keeps more
        late: Callable[[], None] | None = None,  # noqa: ARG002  # rclpy cannot tell
    ) -> RclpySubscription:
        """Call ``callback`` with the serialized messages of a fully qualified topic, on a thread of the middleware."""
        message_class, profile = installed_class(message_type), _profile(qos)
        if self._receiver:
            subscribed = self._receiver.subscribe(message_class, topic, profile, callback, priority)
            return _LentSubscription(self._node, topic, subscribed)
        # raw=True gives serialized messages, so rclpy does not build Python objects that nobody needs.
        subscription = self._node.create_subscription(
            message_class, topic, lambda message: callback([message]), profile, raw=True
        )
        return RclpySubscription(self._node, topic, partial(self._node.destroy_subscription, subscription))

    def endpoints(self, topic: str, publishing: bool) -> list[Endpoint]:
        """Return the publishers or the subscriptions of a topic that rclpy has found so far."""
        if publishing:
            found = self._node.get_publishers_info_by_topic(topic)
            return [Endpoint(_name(info), _qos(info), type=info.topic_type) for info in found]
        found = self._node.get_subscriptions_info_by_topic(topic)
        return [Endpoint(_name(info), _qos(info), tuple(_strict(info.qos_profile)), info.topic_type) for info in found]

    def topics(self) -> Mapping[str, str]:
        """Return the topics of the ROS 2 graph that have publishers, each with the message type of one of them."""
        known = self._node.get_topic_names_and_types()
        return {name: self._type(name, types) for name, types in known if self._node.count_publishers(name)}

    def _type(self, topic: str, types: Sequence[str]) -> str:
        """Return the type of a publisher; ``types`` are those of the topic's publishers and subscriptions."""
        found = self._node.get_publishers_info_by_topic(topic) if len(types) > 1 else ()
        return str(found[0].topic_type) if found else types[0]

    def action(self, action_class: Any, name: str) -> RclpyAction:
        """Create a client of an action, by the class that rosidl generated and the action's fully qualified name."""
        from roverlink.runtime.middleware.rclpy_actions import RclpyAction

        return self._made(lambda: RclpyAction(self._node, self._executor, action_class, name))

    def offer(self, name: str, service: RowService, answer: Callable[[bytes, Respond], None]) -> None:
        """Offer a service with a fully qualified name; its type is that of the installed interface package."""
        from roverlink.runtime.middleware.rclpy_services import offer

        self._made(lambda: offer(self._node, self._executor, name, service, answer))

    def client(self, name: str, service: RowService) -> ServiceClient:
        """Create a client of the service with a fully qualified name."""
        from roverlink.runtime.middleware.rclpy_services import RclpyClient

        return self._made(lambda: RclpyClient(self._node, self._executor, name, service))

    def _made(self, make: Callable[[], T]) -> T:
        """Return what ``make`` returns on the thread of the executor.

        rclpy 9.1 (Kilted) adds a client to the node before the client is complete. An executor that just then collects
        what it waits for ends with an AttributeError, and nothing is ever sent.
        """
        made: Future[T] = Future()

        def run() -> None:
            try:
                made.set_result(make())
            except Exception as error:  # noqa: BLE001  # it is raised by the thread that waits
                made.set_exception(error)

        self._executor.create_task(run)
        return made.result(_MAKING_S)

    def address_changes(self) -> str:
        """Return a text about addresses that have changed since the node joined ROS 2; empty if none have."""
        return self._joined_addresses.changes()

    def set_parameters(self, changes: Mapping[str, Any]) -> None:
        """Change parameters of the own node: those of rclpy, which asks the function of `_declare`."""
        result = self._node.set_parameters_atomically([Parameter(name, value=value) for name, value in changes.items()])
        if not result.successful:
            raise SetupError(result.reason)

    def close(self) -> None:
        """Stop both threads and destroy the node, so that it leaves the ROS 2 graph."""
        if not self._open:
            return
        self._open = False
        if self._receiver and not self._receiver.stop():
            return
        # First the thread, then the executor and the node: a callback that ends while `shutdown` runs misses the guard
        # condition that it triggers, and an executor that waits for what is destroyed may raise InvalidHandle.
        self._executor.create_task(lambda: None)  # it ends the wait
        if not has_ended(self._thread):
            return
        self._executor.shutdown()
        self._held.close()
        self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def _spin(self) -> None:
        # Somebody else in the process may shut ROS 2 down; the program ends by its own signal handler.
        with contextlib.suppress(ExternalShutdownException):
            while self._open:
                self._executor.spin_once(timeout_sec=_SPIN_S)
        if self._receiver:  # rclpy's signal handler shuts contexts down without their callbacks
            self._receiver.end()


def _receiver(node: Any) -> Receiver | None:
    """Start the thread that takes messages; None if this rclpy lacks internal functions that the thread needs."""
    try:
        # Imported here, because the module uses internal names of rclpy.
        from roverlink.runtime.middleware.rclpy_receiving import Receiver

        return Receiver(node)
    except (ImportError, AttributeError, TypeError) as error:
        logging.getLogger("roverlink").warning(
            "this version of rclpy is unknown (%s), so its executor receives the messages, which needs more CPU", error
        )
        return None


def _profile(qos: Qos) -> QoSProfile:
    return QoSProfile(
        reliability=ReliabilityPolicy[qos.reliability.upper()],
        durability=DurabilityPolicy[qos.durability.upper()],
        history=HistoryPolicy[qos.history.upper()],
        depth=qos.depth,
    )


def _name(info: Any) -> str:
    known = info.node_name not in _UNKNOWN_NODES
    return NodeIdentity(info.node_name, info.node_namespace).full_name if known else ""


def _qos(info: Any) -> Qos:
    return Qos(info.qos_profile.reliability.name.lower(), info.qos_profile.durability.name.lower())


def _strict(profile: QoSProfile) -> Iterator[str]:
    """Yield the QoS policies of a subscription that a publisher with ROS 2's defaults does not satisfy."""
    if _is_limited(profile.deadline.nanoseconds):
        yield "deadline"
    if profile.liveliness.name == "MANUAL_BY_TOPIC" or _is_limited(profile.liveliness_lease_duration.nanoseconds):
        yield "liveliness"


def _is_limited(nanoseconds: int) -> bool:
    # rmw has two values for "no limit": zero if nobody has set the duration, and the largest number.
    return 0 < nanoseconds < _INFINITE_NS
