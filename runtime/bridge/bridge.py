"""The bridge: datagrams from the peers to topics, and topics to datagrams for the peers.

Two threads do the work. `Receiver` takes datagrams from the socket, and there they are translated, published and
forwarded; publishing never waits (see `Publisher`), so neither does receiving. The middleware's thread calls back with
what topics say, and there it is translated and sent. Where the table limits rates, or tells what stops a peer, a third
one keeps the time.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, Protocol

from roverlink.runtime.bridge import extra_topics
from roverlink.runtime.bridge.admission import Admission
from roverlink.runtime.bridge.counters import Counters
from roverlink.runtime.bridge.forwarding import Forwarding
from roverlink.runtime.bridge.timekeeper import Tended, Timekeeper
from roverlink.runtime.bridge.to_peer import Outlet, PublisherWatch, Send
from roverlink.runtime.bridge.to_topic import Inlet, PacedInlet
from roverlink.runtime.core.errors import DatagramError, Reason
from roverlink.runtime.core.registry import AnyHandler, Registry
from roverlink.runtime.core.translator import Translation, Translator
from roverlink.runtime.middleware import Middleware, Publisher
from roverlink.runtime.net import udp
from roverlink.runtime.net.destination import Destination
from roverlink.runtime.net.sources import restrict
from roverlink.runtime.ros_arguments.parameters import Parameters

NODE = "udp_forwarder"
"""The bridge's name on the ROS 2 graph, where nobody gives it another."""


Handle = Callable[[udp.Batch], None]


class Observer(Protocol):
    """Hears what passes a bridge. It is asked at start: a bridge without observers does nothing for them."""

    def receiving(self, handle: Handle) -> Handle:
        """What handles batches of received datagrams in the place of ``handle``, and calls it."""

    def sending(self, peer: str, send: Send) -> Send:
        """What sends datagrams made from a topic to a peer in the place of ``send``, and calls it."""


class Bridge:
    """One running bridge. A context manager; `run` works until `stop` is called."""

    def __init__(
        self,
        registry: Registry,
        parameters: Parameters,
        middleware: Middleware,
        topic: Callable[[str], str],
        logger: logging.Logger,
        observers: Sequence[Observer] = (),
    ) -> None:
        """``topic`` gives the fully qualified name of a row's topic. Raises `SetupError` for port and destination."""
        self._registry, self._parameters, self._middleware, self._topic = registry, parameters, middleware, topic
        self._translator = Translator(registry)
        self._logger = logger
        addresses = {name: udp.resolve(parameters.dst_ip, port) for name, port in parameters.peer_ports.items()}
        self._socket = udp.bind(parameters.listen_address, parameters.listen_port, parameters.receive_buffer)
        self._counters = Counters(self._socket, logger)
        self.account = self._counters.account
        self._destinations = {name: Destination(name, address) for name, address in addresses.items()}
        self._observers = observers
        self._receiver = self._receiver_of(parameters)
        self._inlets: dict[str, Inlet] = {}
        self._outlets: list[Outlet] = []
        self._paced: list[PacedInlet] = []
        self._feeding = extra_topics.Feeding(self.account, self._counters.warnings)
        self._forwarding = Forwarding(registry, self._destinations, parameters.forward_policy, self._send, self.account)
        self._failure: BaseException | None = None

    @property
    def port(self) -> int:
        """The UDP port that the bridge listens on."""
        port: int = self._socket.getsockname()[1]
        return port

    def socket_state(self) -> udp.SocketState:
        """How full the socket is, and what the kernel dropped."""
        return udp.socket_state(self._socket)

    def __enter__(self) -> Bridge:
        inbound = [handler for handler in self._registry.handlers if handler.route.inbound]
        for handler in inbound:
            self._inlets[handler.route.name] = self._inlet(handler)
        for feed in self._registry.feeds:
            if feed.route.inbound:
                self._feeding.open(feed, self._publisher(feed).publish)
        handlers: tuple[AnyHandler, ...] = (*self._registry.handlers, *self._registry.feeds)
        outbound = [handler for handler in handlers if not handler.route.inbound]
        self._outlets = [self._outlet(handler) for handler in outbound]
        tended: list[Tended] = [*self._paced, *(outlet for outlet in self._outlets if outlet.is_tended)]
        self._timekeeper = Timekeeper("timekeeper", tended, self._fail)
        for inlet in self._paced:
            inlet.wake = self._timekeeper.wake
        watches = [self._subscribe(handler, outlet) for handler, outlet in zip(outbound, self._outlets)]
        self._watch = Timekeeper("publisher-watch", [watch for watch in watches if watch], self._fail)
        self._warn_of_small_buffer()
        self._timekeeper.__enter__()
        self._watch.__enter__()
        self._receiver.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._receiver.__exit__()
        self._counters.leave(self._receiver.left)
        self._watch.__exit__()
        self._timekeeper.__exit__()
        for inlet in self._paced:
            inlet.end()
        self._middleware.close()
        for outlet in self._outlets:
            outlet.end()
        self._counters.look_at_kernel_drops()
        self._counters.warnings.tell_rest()
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

    def _receiver_of(self, parameters: Parameters) -> udp.Receiver[Any]:
        """The receiver; only where the table restricts who may speak does it look at addresses."""
        size = parameters.max_datagram + 1
        if parameters.source_policy == "any" or not restrict(self._registry.peers):
            return udp.Receiver(self._socket, size, self._observed(self._handle))
        self._admission = Admission(self._registry, self._counters.drop)
        self._admitted: dict[Translator, Handle] = {}
        return udp.Receiver(self._socket, size, self._handle_sourced, udp.source_reader)

    def _observed(self, handle: Handle) -> Handle:
        """The same with the observers before it."""
        for observer in self._observers:
            handle = observer.receiving(handle)
        return handle

    def _handle(self, batch: udp.Batch) -> None:
        self._counters.receive(len(batch))
        self._dispatch(batch, self._translator)

    def _handle_sourced(self, batch: list[udp.Sourced]) -> None:
        """Bridge what comes from who may speak, each as far as it may; observers hear nothing else."""
        self._counters.receive(len(batch))
        for translator, datagrams in self._admission.sort(batch, time.monotonic()).items():
            if translator not in self._admitted:
                self._admitted[translator] = self._observed(partial(self._dispatch, translator=translator))
            self._admitted[translator](datagrams)

    def _dispatch(self, batch: udp.Batch, translator: Translator) -> None:
        fitting = self._without_oversized(batch)
        translation = translator.receive_all(fitting, extra_topics.now())
        for refusal in translation.refusals:
            self._counters.drop(refusal)
        self._publish(translation)
        self._forwarding.forward(fitting, translation.names)

    def _without_oversized(self, batch: udp.Batch) -> udp.Batch:
        longest = self._parameters.max_datagram
        fitting = [datagram for datagram in batch if len(datagram) <= longest]
        for _ in range(len(batch) - len(fitting)):
            self._counters.drop(DatagramError(Reason.OVERSIZED, f"a datagram of more than {longest} bytes"))
        return fitting

    def _publish(self, translation: Translation) -> None:
        for name, messages in translation.messages.items():
            self._inlets[name].take(messages)
        if translation.fed:
            self._feeding.publish(translation.fed)

    def _publisher(self, handler: AnyHandler) -> Publisher:
        return self._middleware.publisher(self._topic(handler.route.topic), handler.message_type, handler.route.qos)

    def _inlet(self, handler: AnyHandler) -> Inlet:
        route = handler.route
        publisher = self._publisher(handler)
        if route.max_rate is None:
            return Inlet(route, publisher, self.account, self._counters.drop)
        self._paced.append(PacedInlet(route, publisher, self.account, self._counters.drop, route.max_rate))
        return self._paced[-1]

    # --- topics to peers ---

    def _send(self, datagrams: Sequence[bytes], destination: Destination) -> int:
        """Send datagrams to a peer, and return how many the network took."""
        refusals = destination.send_all(datagrams)
        for error in refusals:
            self._counters.fail_to_send(destination, error)
        return len(datagrams) - len(refusals)

    def _outlet(self, handler: AnyHandler) -> Outlet:
        destination = self._destinations[handler.route.peer]
        send: Send = partial(self._send, destination=destination)
        for observer in self._observers:
            send = observer.sending(destination.peer, send)
        return Outlet(handler, self._translator, send, self.account, self._counters.warnings)

    def _subscribe(self, handler: AnyHandler, outlet: Outlet) -> PublisherWatch | None:
        route = handler.route

        def take(messages: Sequence[bytes]) -> None:
            try:
                outlet.take(messages)
            except BaseException as failure:
                self._fail(failure)
                raise

        subscription = self._middleware.subscribe(
            self._topic(route.topic), handler.message_type, route.qos, take, route.priority
        )
        return outlet.connect(subscription, self._timekeeper.wake)

    def _fail(self, failure: BaseException) -> None:
        """Something unforeseen ended another thread; whoever waits in `run` has to hear of it."""
        self._failure = failure
        self.stop()

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
