"""The bridge: datagrams from the peers to topics, and topics to datagrams for the peers.

Two threads do the work. `Receiver` takes datagrams from the socket, and there they are translated, published and
forwarded; publishing never waits (see `Publisher`), so neither does receiving. The middleware's thread calls back with
what topics say, and there it is translated and sent.
"""

from __future__ import annotations

import logging
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from typing import NamedTuple

from runtime import udp
from runtime.account import WARNING_INTERVAL_S, Account, ThrottledWarnings
from runtime.destination import Destination
from runtime.errors import ConversionError, DatagramError, Reason
from runtime.middleware import Middleware, Publisher
from runtime.parameters import Parameters
from runtime.registry import AnyHandler, Registry
from runtime.translator import Translator

NODE = "udp_forwarder"
"""The bridge's name on the ROS 2 graph, where nobody gives it another."""


class _Lane(NamedTuple):
    """Where an inbound row's messages and datagrams go."""

    publish: Callable[[Sequence[bytes]], int]
    forward: tuple[Destination, ...]


class Bridge:
    """One running bridge. A context manager; `run` works until `stop` is called."""

    def __init__(
        self,
        registry: Registry,
        parameters: Parameters,
        middleware: Middleware,
        topic: Callable[[str], str],
        logger: logging.Logger,
    ) -> None:
        """``topic`` gives the fully qualified name of a row's topic. Raises `SetupError` for port and destination."""
        self.account = Account()
        self._registry, self._parameters, self._middleware, self._topic = registry, parameters, middleware, topic
        self._translator = Translator(registry)
        self._logger, self._warnings = logger, ThrottledWarnings(logger)
        addresses = {name: udp.resolve(parameters.dst_ip, port) for name, port in parameters.peer_ports.items()}
        self._socket = udp.bind(parameters.listen_address, parameters.listen_port, parameters.receive_buffer)
        self._destinations = {name: Destination(name, address) for name, address in addresses.items()}
        self._receiver = udp.Receiver(self._socket, parameters.max_datagram + 1, self._handle)
        self._lanes: dict[str, _Lane] = {}
        self._to_all = tuple(self._destinations.values()) if parameters.forward_policy == "all" else ()
        self._next_look = 0.0
        self._failure: BaseException | None = None
        self._unsent_lock = threading.Lock()

    @property
    def port(self) -> int:
        """The UDP port that the bridge listens on."""
        port: int = self._socket.getsockname()[1]
        return port

    def __enter__(self) -> Bridge:
        for handler in self._registry.handlers:
            if handler.route.inbound:
                self._lanes[handler.route.name] = _Lane(self._publisher(handler).publish, self._forward_of(handler))
            else:
                self._subscribe(handler)
        self._warn_of_small_buffer()
        self._receiver.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._receiver.__exit__()
        self._middleware.close()
        self._count_lost()
        self._socket.close()
        for destination in self._destinations.values():
            destination.close()

    def stop(self) -> None:
        """Let `run` handle what has arrived and return. May be called from a signal handler."""
        self._receiver.stop()

    def run(self) -> None:
        """Bridge until `stop` is called. Raises whatever unforeseen ended the bridging, in either direction."""
        self._receiver.join()
        if self._failure is not None:
            raise self._failure

    # --- peers to topics ---

    def _handle(self, batch: udp.Batch) -> None:
        self.account.received += len(batch)
        if time.monotonic() >= self._next_look:
            self._next_look = time.monotonic() + WARNING_INTERVAL_S
            self._count_lost()
        messages, forwards = self._translated(self._without_oversized(batch))
        for name, run in messages.items():
            self._publish(name, run)
        for destination, datagrams in forwards.items():
            if sent := self._send(datagrams, destination):
                self.account.forwarded[destination.peer] += sent

    def _translated(self, batch: udp.Batch) -> tuple[dict[str, list[bytes]], dict[Destination, list[bytes]]]:
        """The messages to publish, by the name of the payload, and the datagrams to hand on as they are."""
        messages: defaultdict[str, list[bytes]] = defaultdict(list)
        forwards = dict.fromkeys(self._to_all, batch)
        receive, lanes = self._translator.receive, self._lanes
        for datagram in batch:
            try:
                name, message = receive(datagram)
            except DatagramError as error:
                self._drop(error)
                continue
            messages[name].append(message)
            for destination in lanes[name].forward:
                forwards.setdefault(destination, []).append(datagram)
        return messages, forwards

    def _without_oversized(self, batch: udp.Batch) -> udp.Batch:
        longest = self._parameters.max_datagram
        fitting = [datagram for datagram in batch if len(datagram) <= longest]
        for _ in batch[len(fitting) :]:
            self._drop(DatagramError(Reason.OVERSIZED, f"a datagram of more than {longest} bytes"))
        return fitting

    def _publish(self, name: str, messages: list[bytes]) -> None:
        accepted = self._lanes[name].publish(messages)
        self.account.published[name] += accepted
        number = self._registry.by_name[name].route.number
        for _ in messages[accepted:]:
            self._drop(DatagramError(Reason.NOT_PUBLISHED, f"{name} ({number}): its subscribers are too slow"))

    def _send(self, datagrams: Sequence[bytes], destination: Destination) -> int:
        """How many datagrams went out; those that the network refuses are counted and warned of."""
        refusals = destination.send_all(datagrams)
        for error in refusals:
            with self._unsent_lock:  # both directions come here
                self.account.unsent[destination.peer] += 1
            self._warnings.warn(f"unsent {destination.peer}", f"cannot send to {destination}: {error.strerror}")
        return len(datagrams) - len(refusals)

    def _drop(self, error: DatagramError) -> None:
        self.account.dropped[error.reason.value] += 1
        self._warnings.warn(error.reason.value, f"dropped: {error}")

    def _count_lost(self) -> None:
        """Look at what was lost before it reached us, and warn where it has grown."""
        before = self.account.kernel_drops
        self.account.kernel_drops = udp.kernel_drops(self._socket)
        if lost := self.account.kernel_drops - before:
            self._warnings.warn(
                "lost", f"the kernel dropped {lost} datagrams: they arrive faster than they are handled"
            )

    # --- topics to peers ---

    def _publisher(self, handler: AnyHandler) -> Publisher:
        return self._middleware.publisher(self._topic(handler.route.topic), handler.message_type, handler.route.qos)

    def _forward_of(self, handler: AnyHandler) -> tuple[Destination, ...]:
        """The peers that get the raw datagrams of a row; where all get all, none is left."""
        return () if self._to_all else tuple(self._destinations[peer] for peer in handler.route.forward)

    def _subscribe(self, handler: AnyHandler) -> None:
        route = handler.route
        destination = self._destinations[route.peer]

        def send(messages: Sequence[bytes]) -> None:
            try:
                self._to_peer(handler, destination, messages)
            except BaseException as failure:
                # Raised in a thread of the middleware's; whoever waits in `run` has to hear of it.
                self._failure = failure
                self.stop()
                raise

        self._middleware.subscribe(self._topic(route.topic), handler.message_type, route.qos, send)

    def _to_peer(self, handler: AnyHandler, destination: Destination, messages: Sequence[bytes]) -> None:
        name = handler.route.name
        self.account.taken[name] += len(messages)
        datagrams = []
        for message in messages:
            try:
                datagrams.append(self._translator.send(handler, message))
            except ConversionError as error:
                self.account.refused[name] += 1
                self._warnings.warn(name, f"not sent: {error}")
        sent = self._send(datagrams, destination)
        if sent:
            self.account.sent[name] += sent
        if failed := len(datagrams) - sent:
            self.account.failed[name] += failed

    def _warn_of_small_buffer(self) -> None:
        got, wanted = udp.receive_buffer(self._socket), self._parameters.receive_buffer
        if got < wanted:
            self._logger.warning(
                "the receive buffer is %d bytes where %d were asked for: bursts may be lost; "
                "raise it with `sysctl -w net.core.rmem_max=%d`",
                got,
                wanted,
                wanted,
            )
