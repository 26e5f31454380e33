"""The bridge: datagrams from the peers to topics, and topics to datagrams for the peers.

Three threads. `Receiver` empties the socket and waits for nothing else. The thread that calls `Bridge.run` translates,
publishes and forwards. The middleware's thread calls back with what topics say, which is translated and sent there.
"""

from __future__ import annotations

import logging
import socket
import sys
import time
from collections.abc import Callable
from types import TracebackType

from runtime import udp
from runtime.account import WARNING_INTERVAL_S, Account, ThrottledWarnings
from runtime.errors import ConversionError, DatagramError, Reason
from runtime.middleware import Middleware, Publisher
from runtime.parameters import Parameters
from runtime.registry import AnyHandler, Registry
from runtime.translator import Translator

_INBOX_LIMIT = 65_536  # datagrams
_SWITCH_INTERVAL_S = 0.0005


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
        self._destinations = {
            name: udp.resolve(parameters.dst_ip, port) for name, port in parameters.peer_ports.items()
        }
        self._socket = udp.bind(parameters.listen_address, parameters.listen_port, parameters.receive_buffer)
        self._outgoing = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._inbox = udp.Inbox(_INBOX_LIMIT)
        self._receiver = udp.Receiver(self._socket, parameters.max_datagram + 1, self._inbox)
        self._publishers: dict[str, Publisher] = {}
        self._next_look = 0.0

    @property
    def port(self) -> int:
        """The UDP port that the bridge listens on."""
        port: int = self._socket.getsockname()[1]
        return port

    def __enter__(self) -> Bridge:
        for handler in self._registry.handlers:
            if handler.route.inbound:
                self._publishers[handler.route.name] = self._publisher(handler)
            else:
                self._subscribe(handler)
        self._warn_of_small_buffer()
        self._middleware.__enter__()
        self._receiver.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._receiver.__exit__()
        self._handle_waiting()
        self._middleware.__exit__(kind, error, trace)
        self._count_lost()
        self._socket.close()
        self._outgoing.close()

    def stop(self) -> None:
        """Let `run` handle what has arrived and return. May be called from a signal handler."""
        self._receiver.stop()

    def run(self) -> None:
        """Bridge until `stop` is called."""
        # Two threads share the interpreter; at the default interval of 5 ms the receiving one would come too late.
        sys.setswitchinterval(_SWITCH_INTERVAL_S)
        self._handle_waiting()

    def _handle_waiting(self) -> None:
        """Handle batches until the inbox is closed and empty."""
        while (batch := self._inbox.get()) is not None:
            self._handle(batch)

    # --- peers to topics ---

    def _handle(self, batch: udp.Batch) -> None:
        self.account.received += len(batch)
        if time.monotonic() >= self._next_look:
            self._next_look = time.monotonic() + WARNING_INTERVAL_S
            self._count_lost()
        receive, longest = self._translator.receive, self._parameters.max_datagram
        publishers, published = self._publishers, self.account.published
        forward_all = self._parameters.forward_policy == "all"
        for datagram in batch:
            if len(datagram) > longest:
                self._drop(DatagramError(Reason.OVERSIZED, f"a datagram of more than {longest} bytes"))
                continue
            if forward_all:
                self._forward(datagram, self._destinations)
            try:
                handler, message = receive(datagram)
            except DatagramError as error:
                self._drop(error)
                continue
            route = handler.route
            publishers[route.name].publish(message)
            published[route.name] += 1
            if route.forward and not forward_all:
                self._forward(datagram, route.forward)

    def _forward(self, datagram: bytes, peers: tuple[str, ...] | dict[str, tuple[str, int]]) -> None:
        for peer in peers:
            if self._send(datagram, peer):
                self.account.forwarded[peer] += 1

    def _send(self, datagram: bytes, peer: str) -> bool:
        """Send to a peer; False, counted and warned of, where the network refuses."""
        try:
            self._outgoing.sendto(datagram, self._destinations[peer])
        except OSError as error:
            self.account.unsent[peer] += 1
            self._warnings.warn(f"send to {peer}", f"cannot send to {peer} at {self._destinations[peer]}: {error}")
            return False
        return True

    def _count_lost(self) -> None:
        """Look at what was lost before it reached us, and warn where it has grown."""
        account = self.account
        lost_before = account.kernel_drops + account.dropped[Reason.INBOX_FULL.value]
        account.kernel_drops = udp.kernel_drops(self._socket)
        account.dropped[Reason.INBOX_FULL.value] = self._inbox.overflow
        lost = account.kernel_drops + self._inbox.overflow - lost_before
        if lost:
            self._warnings.warn("lost", f"{lost} datagrams were lost: they arrive faster than they can be handled")

    def _drop(self, error: DatagramError) -> None:
        self.account.dropped[error.reason.value] += 1
        self._warnings.warn(error.reason.value, f"dropped: {error}")

    # --- topics to peers ---

    def _publisher(self, handler: AnyHandler) -> Publisher:
        return self._middleware.publisher(self._topic(handler.route.topic), handler.message_type, handler.route.qos)

    def _subscribe(self, handler: AnyHandler) -> None:
        route = handler.route

        def send(message: bytes) -> None:
            try:
                datagram = self._translator.send(handler, message)
            except ConversionError as error:
                self.account.refused[route.name] += 1
                self._warnings.warn(route.name, f"not sent: {error}")
                return
            if self._send(datagram, route.peer):
                self.account.sent[route.name] += 1

        self._middleware.subscribe(self._topic(route.topic), handler.message_type, route.qos, send)

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
