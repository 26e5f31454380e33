"""The judge: an rclpy node with the classes that rosidl generated. Of roverlink it shares the ROS 2 graph alone.

The bridge is another process, `roverlink run`, whose boards and basestation are sockets of the test.
"""

from __future__ import annotations

import array
import json
import math
import socket
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from importlib import import_module
from typing import Any

import pytest
from needs import NO_RCLPY
from polling import wait_until
from programs import Program, Start
from repeating import repeated

pytest.importorskip("rclpy", reason=NO_RCLPY)

import numpy as np
import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message

from generated.registry import REGISTRY
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Message

_LARGEST = 65_536
_AGAIN_S = 1.0


def repeat(action: Callable[[], Any], until: Callable[[], Any], what: str, every_s: float = 0.05) -> None:
    """Repeat an action until it has been of effect: what is sent before both ends have matched is lost."""
    last = -math.inf

    def done() -> bool:
        nonlocal last
        if time.monotonic() - last > every_s:
            last = time.monotonic()
            action()
        return bool(until())

    wait_until(done, what)


def interface(name: str) -> Any:
    """The class that rosidl generated for a message or a service, such as ``comms/msg/SensorState``."""
    package, kind, type_name = name.split("/")
    return getattr(import_module(f"{package}.{kind}"), type_name)


def values(message: Any) -> Any:
    """A message of rosidl's as mappings, lists and scalars."""
    if hasattr(message, "get_fields_and_field_types"):
        return {name: values(getattr(message, name)) for name in message.get_fields_and_field_types()}
    if isinstance(message, (list, tuple, array.array, np.ndarray)):
        return [values(element) for element in message]
    return message.item() if isinstance(message, np.generic) else message


def message(name: str, said: Mapping[str, Any]) -> Any:
    """A message of rosidl's with these values."""
    made = interface(name)()
    for field, type_name in made.get_fields_and_field_types().items():
        setattr(made, field, _field(type_name, said[field]))
    return made


def _field(type_name: str, said: Any) -> Any:
    if type_name.startswith("sequence<"):
        element = type_name.removeprefix("sequence<").removesuffix(">").partition(",")[0]
        return [_field(element, value) for value in said]
    if isinstance(said, Mapping):
        package, _, name = type_name.partition("/")
        return message(f"{package}/msg/{name}", said)
    return said


def typed(made: Message) -> Any:
    """A message of ours as one of rosidl's."""
    return deserialize_message(cdr.encode(made), interface(made.__msgtype__))


def parameters(**changes: Any) -> list[Any]:
    """Parameters with these values, as services take them."""
    return [Parameter(name, value=value).to_parameter_msg() for name, value in changes.items()]


class Heard:
    """What a subscription of the judge's has received, as values, oldest first."""

    def __init__(self, topic: str) -> None:
        self.topic = topic
        self.values: list[dict[str, Any]] = []

    def wait_for(self, wanted: Mapping[str, Any]) -> None:
        """Wait until a message with these values comes."""
        wait_until(lambda: wanted in self.values, f"{wanted} on {self.topic}; it heard {self.values[-3:]}")


class Judge:
    """An rclpy node, spun by a thread of its own."""

    def __init__(self, domain: int, name: str = "judge") -> None:
        self._context = rclpy.Context()
        rclpy.init(args=[], context=self._context, domain_id=domain)
        self.node = Node(name, context=self._context, use_global_arguments=False)
        self.executor = SingleThreadedExecutor(context=self._context)
        self.executor.add_node(self.node)
        self._open = True
        self._thread = threading.Thread(target=self._spin, daemon=True)
        self._thread.start()

    def on_thread(self, action: Callable[[], object]) -> None:
        """Do something on the thread that spins: rclpy 9.1 adds actions to a node before they are complete."""
        done = self.executor.create_task(action)
        wait_until(done.done, "an action on the thread of the judge")

    def hear(self, topic: str, type_name: str, qos: QoSProfile | int = 10) -> Heard:
        """Subscribe."""
        heard = Heard(topic)
        self.node.create_subscription(
            interface(type_name), topic, lambda received: heard.values.append(values(received)), qos
        )
        self.executor.wake()
        return heard

    def nodes(self) -> list[str]:
        """The nodes on the graph by their full names, without its own."""
        found = [f"{namespace.rstrip('/')}/{name}" for name, namespace in self.node.get_node_names_and_namespaces()]
        return sorted(name for name in found if name != f"/{self.node.get_name()}")

    def wait_for_node(self, name: str) -> None:
        """Wait until a node is on the graph."""
        wait_until(lambda: name in self.nodes(), f"the node {name} among {self.nodes()}")

    def call(self, service: str, type_name: str, request: Any) -> Any:
        """Call a service that is there, and return its response."""
        client = self.node.create_client(interface(type_name), service)
        self.executor.wake()
        wait_until(client.service_is_ready, f"the service {service}")
        # A server that does not know this client's reader yet sends its response to nobody, and DDS does not tell the
        # client when the server knows it. So a request that may be repeated is repeated.
        calls: list[Any] = []
        repeat(
            lambda: calls.append(client.call_async(request)),
            lambda: any(call.done() for call in calls),
            f"an answer of {service}",
            _AGAIN_S,
        )
        return next(call.result() for call in calls if call.done())

    def set_parameters(self, node: str, **changes: Any) -> Any:
        """Set parameters of a node, as `ros2 param set` does it; return the results."""
        kind = "rcl_interfaces/srv/SetParameters"
        request = interface(kind).Request(parameters=parameters(**changes))
        return self.call(f"{node}/set_parameters", kind, request).results

    @contextmanager
    def publishing(
        self, topics: Mapping[str, type[Message]], make: Callable[[int], Iterable[Message]], qos: QoSProfile | int = 5
    ) -> Iterator[None]:
        """Publish numbered messages, one on each topic, again and again until the block ends."""
        node = self.node
        publishers = [node.create_publisher(interface(kind.__msgtype__), topic, qos) for topic, kind in topics.items()]

        def publish(number: int) -> None:
            for publisher, made in zip(publishers, make(number), strict=True):
                publisher.publish(typed(made))

        with repeated(publish, 0.04):
            yield

    def close(self) -> None:
        """Leave the graph, unless it has left."""
        if not self._open:
            return
        self._open = False
        self.executor.create_task(lambda: None)  # it ends the wait
        self._thread.join()
        self.executor.shutdown()
        self.node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def _spin(self) -> None:
        with suppress(ExternalShutdownException):
            while self._open:
                self.executor.spin_once()


class Bridge:
    """`roverlink run` in a process of its own, and the sockets of its peers."""

    def __init__(self, start: Start, middleware: str, arguments: tuple[str, ...], held: ExitStack) -> None:
        self.peers = {peer.name: held.enter_context(_peer_socket()) for peer in REGISTRY.peers}
        ports = {peer.port_parameter: self.peers[peer.name].getsockname()[1] for peer in REGISTRY.peers}
        given = [f"{name}:={port}" for name, port in {"listen_port": 0, **ports}.items()]
        parameters = [part for assignment in given for part in ("-p", assignment)]
        self.program: Program = start(
            "run", "--json", "--middleware", middleware, "--ros-args", *parameters, *arguments
        )
        ready = json.loads(self.program.wait_for('"port"', self.program.output))
        self.node, self._address = ready["node"], ("127.0.0.1", ready["port"])

    def send(self, **payload: Any) -> None:
        """Send one payload, in an envelope, as its peer does."""
        handler = next(one for one in REGISTRY.handlers if one.route.name in payload)
        self.send_datagram(handler.route.peer, REGISTRY.envelope(**payload).SerializeToString())

    def send_datagram(self, peer: str, datagram: bytes) -> None:
        """Send a datagram, as a peer does."""
        self.peers[peer].sendto(datagram, self._address)

    def arrived(self, peer: str) -> Iterator[Any]:
        """The envelopes that have arrived at a peer since the last call."""
        try:
            while True:
                yield REGISTRY.envelope.FromString(self.peers[peer].recv(_LARGEST))
        except BlockingIOError:
            return


def _peer_socket() -> socket.socket:
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.bind(("127.0.0.1", 0))
    sock.setblocking(False)
    return sock
