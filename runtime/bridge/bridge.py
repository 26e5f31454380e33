"""The bridge: it publishes datagrams of peers on topics, and sends messages of topics to peers as datagrams.

Two threads do the work.
- The thread of `udp.Receiver` reads datagrams, translates and publishes them, and forwards them to other peers.
  Publishing never blocks (see `Publisher`), so a slow subscriber cannot delay reading from the socket.
- A thread of the middleware calls the bridge with the messages of topics. On this thread the messages are translated
  to datagrams, and the datagrams are sent.

On both threads, the native core does this work for the rows that take the native way (`NativeWay`).

A third thread, the `Timekeeper`, runs if the table has ``max_rate`` or ``deadman``. A fourth thread looks at the other
nodes: whether the QoS of both ends of a topic match, and, if the middleware does not tell, whether the topics with
``deadman`` still have publishers.
"""

from __future__ import annotations

import logging
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from functools import partial
from typing import Any, Protocol

from roverlink.runtime.bridge import request_rows, service_manager
from roverlink.runtime.bridge.account import Account
from roverlink.runtime.bridge.admission import Admission
from roverlink.runtime.bridge.board_clocks import BoardClocks
from roverlink.runtime.bridge.budgets import BudgetedPeer, Budgets
from roverlink.runtime.bridge.counters import Counters
from roverlink.runtime.bridge.ends import Ends, LinkState
from roverlink.runtime.bridge.extra_topics import ExtraTopics
from roverlink.runtime.bridge.forwarding import Forwarding
from roverlink.runtime.bridge.handling_times import Handle, HandlingTimes, Latencies
from roverlink.runtime.bridge.limited_row import LimitedRow
from roverlink.runtime.bridge.link_exchange import EndReport, LinkExchange
from roverlink.runtime.bridge.loop_watch import LoopWatch
from roverlink.runtime.bridge.native_way import DatagramObserver, NativeWay
from roverlink.runtime.bridge.network_watch import NetworkWatch
from roverlink.runtime.bridge.qos_watch import QosWatch
from roverlink.runtime.bridge.signed_peers import SignedPeers
from roverlink.runtime.bridge.timekeeper import TimedTask, Timekeeper
from roverlink.runtime.bridge.to_peer import OutboundRow, Send
from roverlink.runtime.bridge.to_topic import InboundRow
from roverlink.runtime.core.board_clock import ClockReport
from roverlink.runtime.core.errors import DatagramError, FailedThreadError, Reason, RoverlinkError, SetupError
from roverlink.runtime.core.handler import Stamps
from roverlink.runtime.core.registry import AnyHandler, AnyStandardHandler, EndName, Registry
from roverlink.runtime.core.translator import Translation, Translator
from roverlink.runtime.keys.signed_links import SignedLinks
from roverlink.runtime.middleware import Middleware, Publisher, Subscription
from roverlink.runtime.native.core import NoCoreError, open_core
from roverlink.runtime.net import udp
from roverlink.runtime.net.destination import Destination
from roverlink.runtime.net.hosts import Sender
from roverlink.runtime.net.sources import UNLIMITED, Source, restricts_sources
from roverlink.runtime.ros_arguments.parameters import Parameters
from roverlink.runtime.ros_time.clock import SYSTEM_CLOCK, Clock
from roverlink.runtime.text.host_names import LEARN

NODE = "udp_forwarder"
"""Default node name of the bridge in the ROS 2 graph."""


class Observer(Protocol):
    """Observer of the datagrams that pass a bridge, such as a recorder.

    When a bridge starts, it lets each observer wrap the functions that handle and send datagrams. A bridge without
    observers calls its own functions directly, so it loses no time.
    """

    def receiving(self, handle: Handle) -> Handle:
        """Wrap the function that handles received batches; the returned function must call ``handle``.

        The bridge calls this at start. If the table restricts senders (key ``sources``), the bridge also calls it
        later: each time when datagrams come from a new set of peers.
        """

    def sending(self, peer: str, send: Send) -> Send:
        """Wrap the function that sends datagrams to a peer; the returned function must call ``send``.

        The bridge calls this at start, once for each row and each extra topic that goes to a peer.
        """


class Bridge:
    """Bridge between UDP and ROS 2: publishes datagrams of peers on topics, and sends messages of topics to peers.

    A context manager; inside the block, call `run`, which returns after `stop` is called.
    """

    def __init__(
        self,
        registry: Registry,
        parameters: Parameters,
        middleware: Middleware,
        topic: Callable[[str], str],
        logger: logging.Logger,
        observers: Sequence[Observer] = (),
        links: SignedLinks | None = None,
        clock: Clock = SYSTEM_CLOCK,
    ) -> None:
        """Bind the UDP port.

        ``topic`` returns the fully qualified name of a topic from its name in the table. ``links`` has the keys of the
        peers that must sign. ``clock`` shows the time of reception, for the stamps of messages. Raises `SetupError` if
        the port is in use or a key is missing.
        """
        self._registry, self._parameters, self._middleware, self._topic = registry, parameters, middleware, topic
        self._signed_peers = SignedPeers(registry, links)
        self._translator = self._signed_peers.translator()
        self._logger, self._clock = logger, clock
        self._board_clocks = BoardClocks(registry, clock)
        self._socket = udp.bind(
            parameters.listen_address,
            parameters.listen_port,
            parameters.receive_buffer,
            "--ros-args -p listen_port:=PORT",
        )
        self._counters = Counters(self._socket, logger)
        self._account = self._counters.account
        if links is not None:
            self._account.clocks_ahead = links.verifier.ahead
        self._native: NativeWay | None = None
        self.way = ""
        """Text about the messages that the native core handles, and why it does not handle the others."""
        self._handling_times = HandlingTimes()
        self._sending = self._send if registry.link is None else self._send_counted
        self._ends = Ends(registry, parameters, self._counters, self._socket, self._signed_peers.signing)
        self._budgets = Budgets(registry, self._ends.destinations, self._account)
        self._sender: Sender | None = None  # of the datagrams that are handled now, if an address is to be learned
        self._observers = observers
        self._handle_observed = self._observed(self._handle)
        self._admission = Admission(registry, self._counters.count_dropped, self._signed_peers.translator)
        self._admission.follow(self._ends.lines())
        self._admitted: dict[Translator, Handle] = {}
        self._receiver: udp.Receiver[Any] = udp.Receiver(
            self._socket, parameters.max_datagram + 1, *self._receiving(parameters)
        )
        self._inbound_rows: dict[str, InboundRow] = {}
        self._outbound_rows: list[OutboundRow] = []
        self._extra_topics = ExtraTopics(self._account, self._counters.warnings)
        self._forwarding = Forwarding(
            registry,
            self._ends,
            parameters.forward_policy,
            self._budgets.forwarding(self._signed_peers.forwarding(self._sending)),
            self._budgets.forwarding(self._sending),
            self._counters,
        )
        self._exchanges = request_rows.exchanges(registry)
        self._failure: RoverlinkError | None = None
        self._link = self._exchange(parameters.link_policy)

    @property
    def account(self) -> Account:
        """Counters of the bridge at this moment."""
        self._account.undelivered = self._ends.undelivered() + self._budgets.undelivered()
        self._account.damaged = self._ends.damaged()
        return self._account if self._native is None else self._native.added_to(self._account)

    def latencies(self) -> Latencies:
        """Return the histogram of the times from reading a batch until the batch was published and forwarded."""
        measured = self._handling_times.latencies
        return measured if self._native is None else measured + self._native.latencies()

    @property
    def port(self) -> int:
        """UDP port on which the bridge listens."""
        port: int = self._socket.getsockname()[1]
        return port

    def socket_state(self) -> udp.SocketState:
        """Return the fill level of the socket's receive buffer and the number of datagrams that the kernel dropped."""
        return udp.socket_state(self._socket)

    def link_states(self) -> dict[EndName, LinkState]:
        """Return the addresses of each end of the link, with their state."""
        return self._ends.states()

    def __enter__(self) -> Bridge:
        handlers: tuple[AnyHandler, ...] = (*self._registry.handlers, *self._registry.extra_topics)
        # Before the first topic is open: a bridge that cannot start must not pass on a command.
        parts = [part for handler in handlers for part in handler.route.service_types]
        self._middleware.check_types([*(handler.message_type for handler in handlers), *parts])
        inbound = [handler for handler in self._registry.handlers if handler.route.inbound]
        for handler in inbound:
            self._inbound_rows[handler.route.name] = self._inbound_row(handler)
        for handler in self._registry.extra_topics:
            if handler.route.inbound:
                self._extra_topics.open(handler, self._publisher(handler))
        outbound = [handler for handler in handlers if not handler.route.inbound]
        self._outbound_rows = [self._outbound_row(handler) for handler in outbound]
        woken: list[LimitedRow | BudgetedPeer] = [*self._paced, *self._forwarding.limited]
        woken += self._budgets.peers.values()
        tasks: list[TimedTask] = [*woken, *(row for row in self._outbound_rows if row.is_timed)]
        if self._link is not None:
            tasks.append(self._link)
        if (limit_s := service_manager.watchdog_s()) is not None:
            tasks.append(service_manager.Heartbeat(limit_s, self._progress))
        self._timekeeper = Timekeeper("timekeeper", tasks, self._fail)
        if self._link is not None:
            self._link.wake, self._link.on_start = self._timekeeper.wake, self._renew
        for one in woken:
            one.wake = self._timekeeper.wake
        subscriptions = [self._subscribe(handler, row) for handler, row in zip(outbound, self._outbound_rows)]
        watches = [
            row.connect(subscription, self._timekeeper.wake)
            for row, subscription in zip(self._outbound_rows, subscriptions)
        ]
        routes = {self._topic(handler.route.topic): handler.route for handler in handlers}
        if self._middleware.passes_any_qos:
            routes = {}
        qos_watch = QosWatch(routes, self._middleware.endpoints, self._account, self._counters.warnings)
        network_watch = NetworkWatch(self._middleware.address_changes, self._account, self._counters.warnings)
        looks: list[TimedTask] = [*filter(None, watches), qos_watch, network_watch]
        if self._registry.own is not None:
            taken = [self._topic(handler.route.topic) for handler in outbound]
            looks.append(LoopWatch(taken, self._middleware.endpoints, NODE))
        self._watch = Timekeeper("graph-watch", looks, self._fail)
        self._warn_of_small_buffer()
        for row in (*self._inbound_rows.values(), *self._outbound_rows):
            if isinstance(row, request_rows.RequestFromPeer):
                row.open_client(self._middleware, self._topic)
            elif isinstance(row, request_rows.RequestToPeer):
                row.offer(self._middleware, self._topic)
        self._native = self._native_way([*zip(outbound, self._outbound_rows, subscriptions)])
        self._ends.on_reached = self._reached
        self._ends.start()
        self._timekeeper.__enter__()
        self._watch.__enter__()
        # The receiver starts last: when the first datagram comes in, every topic is open and every timer runs.
        self._choose_way()
        if self._native is not None:
            self._native.loop.__enter__()
        self._receiver.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        # To be read from below, because the stack calls what was added last first. The order matters: first no datagram
        # comes in, then no timer fires, then the waiting messages are published and the topics closed. The stops go out
        # last, because nothing may follow them. If one step fails, the others are done all the same.
        with ExitStack() as steps:
            steps.callback(self._ends.close)
            for budget in self._budgets.peers.values():
                steps.callback(budget.end)
            steps.callback(self._socket.close)
            steps.callback(self._counters.warnings.log_suppressed)
            steps.callback(self._counters.read_kernel_drops)
            for row in reversed(self._outbound_rows):
                steps.callback(row.end)
            if self._native is not None:
                steps.callback(self._native.end)
            steps.callback(self._middleware.close)
            for limited in self._forwarding.limited:
                steps.callback(limited.end)
            for paced in reversed(self._paced):
                steps.callback(paced.end)
            for row in self._outbound_rows:
                if isinstance(row, request_rows.RequestToPeer):
                    steps.callback(row.end_calls)
            steps.callback(self._timekeeper.__exit__)
            steps.callback(self._watch.__exit__)
            if self._native is not None:
                steps.callback(self._native.loop.__exit__)
            steps.callback(lambda: self._counters.count_unhandled(self._receiver.left))
            steps.callback(self._receiver.__exit__)

    def stop(self) -> None:
        """Make `run` return as soon as the datagrams that have already arrived are handled.

        Safe to call in a signal handler.
        """
        self._receiver.stop()

    def run(self) -> None:
        """Wait until `stop` is called. Raises `FailedThreadError` if an error ended a thread of the bridge.

        Raises `SetupError` if the rover's bridge has the same topics as this one, which is the other end of the link.
        """
        self._receiver.join()
        if self._failure is not None:
            raise self._failure

    def _progress(self) -> tuple[int, int]:
        """Return numbers of which one grows while the receive thread works, and wake the thread.

        A native loop does not return while datagrams arrive, so their number counts, too.
        """
        return self._receiver.look_again(), self.account.received

    def change(self, parameters: Parameters) -> None:
        """Use changed parameters from now on; the values of read-only parameters must be the same as before.

        The changes cannot fail: a host that does not resolve is looked up again and again, as after the start.
        """
        before, self._parameters = self._parameters, parameters
        self._ends.follow(parameters)
        self._admission.follow(self._ends.lines())
        self._forwarding.follow(parameters.forward_policy)
        if self._link is not None:
            self._link.follow(parameters.link_policy)
        if self._reading(parameters) != self._reading(before):
            self._receiver.pass_to(*self._receiving(parameters))
        if self._native is not None:
            self._native.follow(parameters.forward_policy)
        self._choose_way()
        if parameters.receive_buffer != before.receive_buffer:
            udp.size_receive_buffer(self._socket, parameters.receive_buffer)
            self._warn_of_small_buffer()

    # --- the link messages ---

    def link_reports(self) -> list[EndReport]:
        """Return what the link messages of each end tell; empty for a table without the link message."""
        return self._link.reports() if self._link is not None else []

    def clock_reports(self) -> dict[EndName, ClockReport]:
        """Return what is known of the clock of each board that stamps messages (table key ``clock: board``)."""
        return self._board_clocks.reports()

    def _exchange(self, policy: str) -> LinkExchange | None:
        link = self._registry.link
        if link is None:
            return None
        sends = {
            end: self._budgets.sending(
                self._signed_peers.sending(end, partial(self._send, destination=destination), destination),
                destination,
            )
            for end, destination in self._ends.destinations.items()
        }
        return LinkExchange(
            self._registry, link.hashes, sends, self._refuse_rows, policy, self._account, self._counters.warnings
        )

    def _refuse_rows(self, rows: frozenset[str], forwards: Mapping[EndName, frozenset[str]]) -> None:
        """Refuse the messages of rows in both directions, and forward some rows no longer to some ends."""
        self._translator.refuse(rows)
        self._admission.refuse(rows)
        for row in self._outbound_rows:
            row.refused = row.name in rows
        self._forwarding.refuse(forwards)
        if self._native is not None:
            self._native.refuse(rows, forwards)
        self._timekeeper.wake()  # a request that is refused gets its answer now

    # --- the native way ---

    def _native_way(self, outbound: Sequence[tuple[AnyHandler, OutboundRow, Subscription]]) -> NativeWay | None:
        """Return the way through the native core; None if there is no core, or if Python has to see all datagrams."""
        if reason := self._why_python():
            self.way = f"Python handles all messages ({reason})"
            return None
        try:
            way = NativeWay(
                self._registry,
                open_core(self._registry),
                self._inbound_rows,
                self._extra_topics.publishers,
                outbound,
                self._ends.destinations,
                self._forwarding.limited,
                self._signed_peers,
                [one for one in self._observers if isinstance(one, DatagramObserver)],
                request_rows.in_python(self._exchanges),
            )
        except (NoCoreError, AttributeError, OSError) as error:  # the middleware's library may be another version
            self.way = f"Python handles all messages ({error})"
            return None
        sock, wake = self._receiver.sockets
        way.loop.open(
            sock,
            wake,
            self._parameters.max_datagram + 1,
            self._not_accepted,
            lambda _: self._timekeeper.wake(),
            lambda destination, datagrams: self._forwarding.hand_on(datagrams, destination),
            self._settled,
            lambda: self._counters.count_received(0),
        )
        way.follow(self._parameters.forward_policy)
        self.way = way.summary()
        if not way.is_used:
            return None
        self._admission.gate.on_forgotten = way.loop.forget_senders
        if self._link is not None:
            self._link.native = way
        return way

    def _why_python(self) -> str:
        """Return the reason why no message may take the native way; empty if there is none."""
        if not self._parameters.native_core:
            return "the parameter native_core is false"
        if self._clock is not SYSTEM_CLOCK:
            return "the stamps are those of a simulated clock"
        able = all(isinstance(one, DatagramObserver) for one in self._observers)
        return "" if able else "an observer has to see the datagrams before the bridge does"

    def _choose_way(self) -> None:
        """Let the native core read the socket, and pass the datagrams that it does not handle to the right function."""
        if self._native is None:
            return
        handle, reader = self._receiving(self._parameters)
        self._native.loop.pass_to(handle, _WITH_SENDER[reader])
        self._receiver.use(self._native.loop)

    def _settled(self, row: str, sender: Sender) -> Source | None:
        """Return a sender if another datagram of a row from it needs no decision but its rate: it teaches nothing."""
        if not self._ends.knows(row, sender.address):
            return None
        restricts, _ = self._reading(self._parameters)
        if not restricts:
            return UNLIMITED
        return self._admission.settled(self._registry.by_name[row].route, sender)

    def _reading(self, parameters: Parameters) -> tuple[bool, bool]:
        """Return how datagrams are read: true if senders are checked, and true if the address of an end is learned."""
        ends = parameters.addresses.values()
        restricts = restricts_sources(self._registry.peers) or any(end.is_line for end in ends)
        return restricts and parameters.source_policy == "mapping", any(end.hosts == (LEARN,) for end in ends)

    @property
    def _paced(self) -> list[InboundRow]:
        """Rows from peers with a limit of the rate."""
        return [row for row in self._inbound_rows.values() if row.is_limited]

    def _renew(self, end: EndName) -> None:
        """Send the last states of the rows with `on_change` to an end again, because another program may be there."""
        for row in self._outbound_rows:
            if self._registry.end_of(self._registry.by_name[row.name].route) == end:
                row.renew()
        for forward in self._forwarding.limited:
            if forward.destination.end == end:
                forward.renew()

    def _reached(self, end: EndName) -> None:
        """Take note that the line to an end works, or that its address is another one."""
        if self._native is not None:
            self._native.loop.forget_senders()
        self._renew(end)

    def _not_accepted(self, handler: AnyHandler | AnyStandardHandler) -> None:
        """Count a message of the native core that the middleware has not accepted."""
        if handler in self._extra_topics.publishers:
            self._extra_topics.not_accepted(handler, 1)
        else:
            self._inbound_rows[handler.route.name].not_accepted()

    # --- peers to topics ---

    def _receiving(self, parameters: Parameters) -> tuple[Callable[[list[Any]], None], Callable[..., Any]]:
        """Return the function that handles batches, and the function that makes their reader, for `udp.Receiver`.

        The addresses of senders are read only if the table restricts senders, or if an end's address is learned,
        because reading them costs time.
        """
        restricts, learns = self._reading(parameters)
        handle: Callable[[list[Any]], None] = self._handle_with_sources if restricts else self._handle_observed
        if learns:
            return partial(self._handle_and_learn, handle, restricts), udp.sender_reader
        return handle, udp.sender_reader if restricts else udp.reader

    def _observed(self, handle: Handle) -> Handle:
        """Let all observers wrap a function that handles batches, and return the wrapped function."""
        handle = self._handling_times.timed(handle)
        for observer in self._observers:
            handle = observer.receiving(handle)
        return handle

    def _handle(self, batch: udp.Batch) -> None:
        self._counters.count_received(len(batch))
        self._dispatch(batch, self._translator)

    def _handle_with_sources(self, batch: list[udp.SentDatagram]) -> None:
        """Bridge the datagrams whose senders are admitted; observers do not see the other datagrams."""
        self._counters.count_received(len(batch))
        for translator, datagrams in self._admission.sort(batch, time.monotonic()).items():
            if translator not in self._admitted:
                self._admitted[translator] = self._observed(partial(self._dispatch, translator=translator))
            self._admitted[translator](datagrams)

    def _handle_and_learn(
        self, handle: Callable[[list[Any]], None], restricts: bool, batch: list[udp.SentDatagram]
    ) -> None:
        """Bridge the datagrams of each sender with ``handle``, so that `_dispatch` can learn the sender's address.

        If the table ``restricts`` senders, ``handle`` gets each datagram with its sender.
        """
        by_sender: defaultdict[Sender, list[Any]] = defaultdict(list)
        for datagram, sender in batch:
            by_sender[sender].append((datagram, sender) if restricts else datagram)
        for sender, datagrams in by_sender.items():
            self._sender = sender
            handle(datagrams)
        self._sender = None

    def _dispatch(self, batch: udp.Batch, translator: Translator) -> None:
        # The receiver reads one byte more than allowed, so a longer datagram is recognized although the kernel cut it.
        fitting = self._without_oversized(batch)
        stamps = self._board_clocks.stamps()
        translation = translator.receive_all(fitting, stamps)
        for refusal in translation.refusals:
            self._counters.count_dropped(refusal)
        self._publish(translation, stamps)
        speakers = self._take_links(self._link, translation) if self._link is not None else []
        # Forward after publishing: topics have priority, and the policy `mapping` needs the names.
        self._forwarding.forward(fitting, translation.names, translation.restored)
        if self._sender is not None:
            self._ends.learn(translation.names, speakers, self._sender.address)

    def _without_oversized(self, batch: udp.Batch) -> udp.Batch:
        longest = self._parameters.max_datagram
        fitting = [datagram for datagram in batch if len(datagram) <= longest]
        for _ in range(len(batch) - len(fitting)):
            self._counters.count_dropped(
                DatagramError(Reason.OVERSIZED, f"a datagram of more than {longest} bytes (parameter max_datagram)")
            )
        return fitting

    def _take_links(self, link: LinkExchange, translation: Translation) -> list[EndName]:
        speakers = link.take(translation)
        for end in speakers:
            self._board_clocks.exchanged(end, link.exchanges(end))
        return speakers

    def _publish(self, translation: Translation, stamps: Stamps) -> None:
        for name, messages in translation.messages.items():
            self._inbound_rows[name].take(messages)
        self._extra_topics.publish(translation.extra_topics, stamps)

    def _publisher(self, handler: AnyHandler) -> Publisher:
        return self._middleware.publisher(self._topic(handler.route.topic), handler.message_type, handler.route.qos)

    def _inbound_row(self, handler: AnyHandler) -> InboundRow:
        route = handler.route
        publisher = self._publisher(handler)
        if (exchange := self._exchanges.get(route.name)) is not None:
            return request_rows.inbound_row(exchange, handler, publisher, self._account, self._counters.count_dropped)
        return InboundRow(route, publisher, self._account, self._counters.count_dropped)

    # --- topics to peers ---

    def _send(self, datagrams: Sequence[bytes], destination: Destination) -> int:
        """Send datagrams to an end and return how many of them the network accepted."""
        refusals = destination.send_all(datagrams)
        for error in refusals:
            self._counters.count_unsent(destination, error)
        return len(datagrams) - len(refusals)

    def _send_counted(self, datagrams: Sequence[bytes], destination: Destination) -> int:
        """Send datagrams to a peer, and count them for its link messages."""
        sent = self._send(datagrams, destination)
        if self._link is not None:  # a link message counts itself
            self._link.count_sent(destination.end, sent)
        return sent

    def _outbound_row(self, handler: AnyHandler) -> OutboundRow:
        route, destination = handler.route, self._ends.destinations[self._registry.end_of(handler.route)]
        # Observers see the datagram without its signature, which is new each time that the datagram is sent.
        send: Send = partial(self._sending, destination=destination)
        send = self._signed_peers.sending(EndName(route.peer, route.board), send, destination)
        for observer in self._observers:
            send = observer.sending(route.peer, send)
        send = self._budgets.sending(send, destination)
        given = (handler, self._translator, send, self._account, self._counters.warnings)
        exchange = self._exchanges.get(route.name)
        return OutboundRow(*given) if exchange is None else request_rows.outbound_row(exchange, *given)

    def _subscribe(self, handler: AnyHandler, row: OutboundRow) -> Subscription:
        route = handler.route

        def take(messages: Sequence[bytes]) -> None:
            try:
                row.take(messages)
            # It would end only the middleware's thread, and the bridge would run on without its topics.
            except BaseException as failure:
                self._fail(failure)
                raise

        return self._middleware.subscribe(
            self._topic(route.topic), handler.message_type, route.qos, take, route.priority, late=row.count_late
        )

    def _fail(self, failure: BaseException) -> None:
        """Stop the bridge because the calling thread failed; `run` raises the error."""
        if not isinstance(failure, SetupError):  # which only shows after the start
            failure = FailedThreadError(threading.current_thread().name, failure)
        self._failure = self._failure or failure
        self.stop()

    def _warn_of_small_buffer(self) -> None:
        got, wanted = udp.receive_buffer(self._socket), self._parameters.receive_buffer
        if got < wanted:
            self._logger.warning(
                "the UDP receive buffer has %d bytes instead of %d: datagrams of a burst may be lost; "
                "allow more with `sysctl -w net.core.rmem_max=%d`",
                got,
                wanted,
                wanted,
            )


_WITH_SENDER: dict[Callable[..., Any], Callable[[bytes, Sender], Any] | None] = {
    udp.reader: None,
    udp.sender_reader: lambda datagram, sender: (datagram, sender),
}
"""Function that makes a member of a batch, by the function that makes the batch's reader.

It takes a datagram and its sender; None if a member is only the datagram.
"""
