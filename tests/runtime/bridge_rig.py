"""A bridge between the sockets of a test and topics in memory, and the sample's registry as other tables make it."""

from __future__ import annotations

import contextlib
import dataclasses
import logging
import socket
from collections import defaultdict
from collections.abc import Callable, Sequence
from typing import Any

from polling import PATIENCE_S, wait_until

from generated.registry import REGISTRY
from roverlink.runtime import Bridge, Qos, Registry
from roverlink.runtime.bridge.bridge import Observer, Send
from roverlink.runtime.bridge.handling_times import Handle
from roverlink.runtime.core.registry import AnyHandler
from roverlink.runtime.keys.signed_links import SignedLinks
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.ros_arguments import parameters
from roverlink.runtime.ros_arguments.live_parameters import LiveParameters
from roverlink.runtime.ros_time.clock import SYSTEM_CLOCK, Clock

LOGGER = logging.getLogger("bridge")

# --- registries -------------------------------------------------------------------------------------------------


def changed(registry: Registry, name: str, /, **changes: Any) -> Registry:
    """A registry whose row of a name says something else."""
    handlers = [_with_route(one, **changes) if one.route.name == name else one for one in registry.handlers]
    return dataclasses.replace(registry, handlers=tuple(handlers))


def of_peers(registry: Registry, **changes: dict[str, Any]) -> Registry:
    """A registry whose peers, by name, say something else."""
    peers = [dataclasses.replace(peer, **changes.get(peer.name, {})) for peer in registry.peers]
    return dataclasses.replace(registry, peers=tuple(peers))


def end(name: str, host: str, port: int = 9, **more: Any) -> dict[str, Any]:
    """What a table says of a peer or board with a host of its own."""
    return {"host": host, "host_parameter": f"{name}_host", "port_parameter": f"{name}_port", "port": port, **more}


def _with_route(handler: AnyHandler, **changes: Any) -> AnyHandler:
    route = dataclasses.replace(handler.route, **changes)
    made: AnyHandler = type(type(handler).__name__, (type(handler),), {"route": route})()
    return made


QUIET = dataclasses.replace(REGISTRY, handlers=tuple(_with_route(one, deadman=None) for one in REGISTRY.handlers))
"""The registry without the stops that a bridge sends by itself."""

INBOUND = [handler for handler in REGISTRY.handlers if handler.route.inbound]
OUTBOUND = [handler for handler in REGISTRY.handlers if not handler.route.inbound]


def envelope(**payloads: Any) -> bytes:
    """A datagram of the sample's table."""
    return bytes(REGISTRY.envelope(**payloads).SerializeToString())


# --- sockets ----------------------------------------------------------------------------------------------------


def listener(host: str = "127.0.0.1", port: int = 0) -> socket.socket:
    """A socket that waits patiently, with room for many datagrams."""
    sock = socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET, socket.SOCK_DGRAM)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024 * 1024)
    sock.bind((host, port))
    sock.settimeout(PATIENCE_S)
    return sock


def port_of(sock: socket.socket) -> int:
    """The port of a socket."""
    return int(sock.getsockname()[1])


def waiting(sock: socket.socket) -> list[bytes]:
    """The datagrams that have arrived at a socket."""
    found: list[bytes] = []
    sock.setblocking(False)
    with contextlib.suppress(BlockingIOError):
        while True:
            found.append(sock.recv(65_536))
    sock.settimeout(PATIENCE_S)
    return found


# --- the bridge -------------------------------------------------------------------------------------------------


class _Handled:
    """Counts the datagrams that the bridge has published, forwarded and learned from, or dropped."""

    count = 0

    def receiving(self, handle: Handle) -> Handle:
        """Count a batch after the bridge has handled it."""

        def counted(batch: list[bytes]) -> None:
            handle(batch)
            self.count += len(batch)

        return counted

    def sending(self, peer: str, send: Send) -> Send:
        """Change nothing."""
        return send


class Rig:
    """A bridge, a socket for each peer without a host of its own, a board that sends, and a ROS 2 node."""

    def __init__(
        self,
        registry: Registry = QUIET,
        middleware: Callable[[Graph], Any] = MemoryMiddleware,
        observers: Sequence[Observer] = (),
        links: SignedLinks | None = None,
        topic: str = "/{}",
        clock: Clock = SYSTEM_CLOCK,
        **given: Any,
    ) -> None:
        self.stack = contextlib.ExitStack()
        self.registry, self.graph, self._handled = registry, Graph(), _Handled()
        self.peers = {peer.name: self.stack.enter_context(listener()) for peer in registry.peers}
        here = [peer for peer in registry.peers if not (peer.host or peer.boards)]
        ports = {peer.port_parameter: port_of(self.peers[peer.name]) for peer in here}
        settings = parameters.read(registry, {"listen_port": 0, "listen_address": "127.0.0.1", **ports, **given})
        self.topic, observers = topic.format, [self._handled, *observers]
        self.bridge = Bridge(registry, settings, middleware(self.graph), self.topic, LOGGER, observers, links, clock)
        self.live = LiveParameters(registry, settings, LOGGER)
        self.live.on_change(self.bridge.change)
        self.account = self.bridge.account
        self.board = self.stack.enter_context(listener())
        self.node = MemoryMiddleware(self.graph)
        self.on_topic: defaultdict[str, list[bytes]] = defaultdict(list)
        self.listen(*(handler.route.topic for handler in registry.handlers if handler.route.inbound))

    def __enter__(self) -> Rig:
        self.bridge.__enter__()
        return self

    def __exit__(self, failure: object, *_: object) -> None:
        self.bridge.stop()
        self.bridge.__exit__()
        self.stack.close()
        assert failure or not self.account.discrepancies()

    def listen(self, *topics: str) -> None:
        """Keep what comes on topics of the table."""
        for topic in topics:
            message_type = self.registry.by_topic[topic].message_type
            self.node.subscribe(self.topic(topic), message_type, Qos(), self.on_topic[topic].extend)

    def send(self, *datagrams: bytes, via: socket.socket | None = None) -> None:
        """Send datagrams as a board, or by another socket."""
        sock = via or self.board
        for datagram in datagrams:
            sock.sendto(datagram, ("::1" if sock.family == socket.AF_INET6 else "127.0.0.1", self.bridge.port))

    def receive(self, *datagrams: bytes, via: socket.socket | None = None) -> None:
        """Send datagrams to the bridge, and wait until it has handled them."""
        for start in range(0, len(datagrams), 100):
            batch = datagrams[start : start + 100]
            wanted = self.account.received + len(batch)
            self.send(*batch, via=via)
            wait_until(lambda wanted=wanted: self.account.received >= wanted, f"{wanted} datagrams")  # type: ignore[misc]
            wait_until(self._is_settled, "a bridge without work")

    def _is_settled(self) -> bool:
        unseen = self.account.dropped["unknown_source"] + self.account.dropped["over_rate"]  # by any observer
        return self._handled.count + unseen == self.account.received

    def publish(self, row: str, *payloads: Any) -> bytes:
        """Publish payloads, or messages as they are, as a node does; else an empty one. The last one's datagram."""
        handler = self.registry.by_name[row]
        payloads = payloads or (handler.payload_type(),)
        messages = [one if isinstance(one, bytes) else handler.to_cdr(one) for one in payloads]
        publisher = self.node.publisher(self.topic(handler.route.topic), handler.message_type, Qos())
        publisher.publish(messages)
        last = payloads[-1]
        return b"" if isinstance(last, bytes) else self.registry.envelope(**{row: last}).SerializeToString()

    def arrived(self, peer: str, at_least: int = 0) -> list[bytes]:
        """What a peer has got, once it has got so many."""
        return [self.peers[peer].recv(65_536) for _ in range(at_least)] + waiting(self.peers[peer])
