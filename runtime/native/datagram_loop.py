"""Reception of datagrams by the native core: from the socket to topics and to other peers without Python.

`DatagramLoop` makes the structs that the core's thread works with, and takes the calls for what the core cannot do.
The bridge decides which rows are native, and may decide anew at any time.
"""

from __future__ import annotations

import ctypes
import socket
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from roverlink.runtime.core.registry import AnyHandler, AnyStandardHandler
from roverlink.runtime.core.signing import Stream
from roverlink.runtime.core.tap import Tap
from roverlink.runtime.native import bridge_layout as native
from roverlink.runtime.native.core import NativeCore, NoCoreError
from roverlink.runtime.native.lending import NativePublisher
from roverlink.runtime.native.observer_ring import ObserverRing
from roverlink.runtime.native.python_calls import PythonCalls
from roverlink.runtime.net.destination import Destination, can_segment
from roverlink.runtime.net.hosts import Sender, sender_of
from roverlink.runtime.net.sources import Source

ANY_LENGTH = 0xFFFFFFFF
"""Length of the longest datagram of a row whose datagrams may have any length."""


@dataclass(frozen=True, slots=True)
class InboundTopics:
    """Inbound row with its publishers, as the native core needs them."""

    handler: AnyHandler
    publishers: Sequence[tuple[AnyHandler | AnyStandardHandler, Any]]
    """Handler and publisher of the row's own topic, then those of its extra topics."""
    forward: int = 0
    """Destinations to which the row's datagrams are forwarded: bit by index."""
    forward_pacers: Mapping[int, int | None] = field(default_factory=dict)
    """Addresses of the limits of the forwards, by the index of the destination."""
    longest: int = ANY_LENGTH
    """Length in bytes of the longest datagram that all of them take."""
    pacer: int | None = None
    """Address of the limit of the rate of the row's own topic."""
    streams: Sequence[Stream] | None = None
    """Keys that may sign the datagrams; None if they need no signature."""


class NativeCounts(NamedTuple):
    """Counters of the native core at one moment."""

    received: int
    """Datagrams that the core handled itself."""
    published: Counter[str]
    """Messages published on the rows' own topics, by row."""
    last_published: Mapping[str, float]
    """Time of the last of them, in seconds of the monotonic clock, by row; 0 if there was none."""
    extra_published: Counter[str]
    """Messages published on extra topics, by topic in the table."""
    forwarded: Sequence[int]
    """Datagrams sent to each destination."""


class DatagramLoop:
    """Loop of the native core for one bridge, with its counters. One thread at a time may call `run`.

    A context manager: on exit, the observers get the rest.
    """

    def __init__(
        self,
        core: NativeCore,
        rows: Sequence[InboundTopics],
        destinations: Sequence[tuple[Destination, native.Signer | None]],
        signature: int,
        is_ordered: bool,
        at_once: Sequence[int],
        bounds: Sequence[float],
        observers: Sequence[Tap],
    ) -> None:
        """Prepare the loop; no row is native yet (see `rows`).

        ``destinations`` come with the signers of what is forwarded there; ``signature`` is the number of the envelope's
        field with a signature. With ``is_ordered``, no datagram is handled before an earlier one that is handed over.
        Datagrams with the payload numbers ``at_once`` are handed over before any later one is handled. ``bounds`` are
        those of the histogram of handling times, in seconds. ``observers`` get a copy of each datagram.
        """
        self._core, self._destinations = core, [destination for destination, _ in destinations]
        self.reasons: dict[str, str] = {}
        """Reason why Python translates the datagrams of a row, by the row's name."""
        able = [row for row in rows if self._is_able(row)]
        self._topics = [handler for row in able for handler, _ in row.publishers]
        self._own = {id(row.handler) for row in able}
        self._topic_structs = (native.Topic * len(self._topics))()
        numbered = {number: native.Row(number=number, at_once=1, longest=ANY_LENGTH) for number in at_once}
        functions, first = native.MiddlewareFunctions(), 0
        taps: dict[int, Sequence[Tap]] = {len(self._topics): observers}
        for row in able:
            number = row.handler.route.number
            numbered[number] = native.Row(
                number=number,
                first_topic=first,
                topics=len(row.publishers),
                forward=row.forward,
                forward_pacers=_pacers(row.forward_pacers, len(destinations)),
                longest=row.longest,
                is_signed=row.streams is not None,
                signers=_bits(stream.id for stream in row.streams or ()),
            )
            for index, (handler, publisher) in enumerate(row.publishers, first):
                self._topic_structs[index].pacer = row.pacer if handler is row.handler else None
                self._topic_structs[index].translation = core.index_of(handler)
                taps[index] = publisher.lend_to(self._topic_structs[index], functions)
                self._topic_structs[index].observed = bool(taps[index])
                if handler.route.qos.durability == "transient_local":  # for subscribers that come later
                    self._topic_structs[index].wanted = True
            first += len(row.publishers)
        self._row_structs = (native.Row * len(numbered))(*(numbered[number] for number in sorted(numbered)))
        names = {row.handler.route.number: row.handler.route.name for row in able}
        self.rows = {names[row.number]: row for row in self._row_structs if row.number in names}
        """Struct of each row that the core can translate, by the row's name. Its ``native`` says whether it does."""
        self._destination_structs = (native.Destination * len(destinations))(
            *(
                native.Destination(
                    socket=ctypes.pointer(one.connected_socket),
                    signer=None if signer is None else ctypes.pointer(signer),
                    segments=can_segment(),
                )
                for one, signer in destinations
            )
        )
        streams = {stream.id: stream for row in able for stream in row.streams or ()}
        self._bounds = (ctypes.c_double * len(bounds))(*bounds)
        self._python = PythonCalls()
        self._look: Callable[[], None] = lambda: None
        self._path: tuple[Callable[[list[Any]], None], Callable[[bytes, Sender], Any] | None] = (lambda _: None), None
        self._python.ring = ObserverRing(core, taps, "observe-datagrams") if any(taps.values()) else None
        self._bridge = native.Bridge(
            table=ctypes.pointer(core.table),
            workspace=core.new_workspace(self),
            topics=self._topic_structs,
            rows=self._row_structs,
            destinations=self._destination_structs,
            streams=(ctypes.POINTER(Stream) * len(streams))(*map(ctypes.pointer, streams.values())),
            middleware=functions,
            observers=ctypes.pointer(self._python.ring.struct) if self._python.ring is not None else None,
            observed=bool(observers),
            bounds=self._bounds,
            n_topics=len(self._topics),
            n_rows=len(self._row_structs),
            n_destinations=len(destinations),
            n_bounds=len(bounds),
            n_streams=len(streams),
            signature=signature,
            is_ordered=is_ordered,
        )
        if core.library.rl_check_bridge(ctypes.byref(self._bridge)):
            raise NoCoreError("the native library refuses the bridge; report this as a bug of roverlink")

    def _is_able(self, row: InboundTopics) -> bool:
        """Return true if the core can translate a row; else store the reason."""
        route = row.handler.route
        for handler, publisher in row.publishers:
            if reason := self._core.reason(handler):
                self.reasons[route.name] = f"{handler.route.topic}: {reason}"
            elif not isinstance(publisher, NativePublisher):
                self.reasons[route.name] = "the middleware publishes in Python"
        return route.name not in self.reasons

    def open(
        self,
        sock: socket.socket,
        wake: socket.socket,
        largest: int,
        not_published: Callable[[AnyHandler | AnyStandardHandler], None],
        wait: Callable[[str], None],
        send: Callable[[Destination, list[bytes]], object],
        admit: Callable[[str, Sender], Source | None],
        look: Callable[[], None],
    ) -> None:
        """Read from ``sock``, at most ``largest`` bytes of a datagram; data on ``wake`` ends the wait for datagrams.

        ``not_published`` gets the handler of a message that the middleware has not accepted. ``wait`` gets the name of
        a row of which a message waits for its time. ``send`` gets the datagrams that the core cannot send. If senders
        are checked, ``admit`` returns the sender if Python need not see its datagrams of a row until `forget_senders`
        is called, as long as it keeps its rate. ``look`` is called once in two seconds while datagrams arrive.
        """
        self._look = look
        topics, destinations = self._topics, self._destinations
        names = {row.number: name for name, row in self.rows.items()}
        rows = [names.get(row.number, "") for row in self._row_structs]

        guarded, unobserved = self._python.guarded, self._python.unobserved
        self._bridge.calls = native.Calls(
            native.Handle(lambda datagrams, count: guarded(self._hand_over, datagrams, count)),
            native.OfTopic(lambda topic: unobserved(not_published, topics[topic])),
            native.OfTopic(lambda topic: unobserved(wait, topics[topic].route.name)),
            native.Send(lambda index, datagrams, count: guarded(send, destinations[index], _bytes(datagrams, count))),
            native.Admit(lambda index, datagram: _address(admit(rows[index], _sender(datagram[0])))),
        )
        self._bridge.socket, self._bridge.wake, self._bridge.largest = sock.fileno(), wake.fileno(), largest

    def pass_to(self, handle: Callable[[list[Any]], None], with_sender: Callable[[bytes, Sender], Any] | None) -> None:
        """Pass the datagrams that the core does not handle to ``handle``.

        If the senders are checked, ``with_sender`` makes a member of the batch of a datagram and its sender.
        """
        self._path = handle, with_sender  # one assignment, because each handler has its own form of batches
        self._bridge.checks_senders = with_sender is not None
        self.forget_senders()

    def follow(self, *, forwards_all: bool) -> None:
        """Forward all datagrams to all destinations as they are from now on, or those of each row to the row's."""
        self._bridge.forwards_all = forwards_all

    def forget_senders(self) -> None:
        """Ask again which rows may come from which senders."""
        self._bridge.senders += 1

    def _hand_over(self, datagrams: Any, count: int) -> None:
        handle, with_sender = self._path
        if count == 0:
            self._look()
            return
        if with_sender is None:
            handle(_bytes(datagrams, count))
            return
        found = [datagrams[index] for index in range(count)]
        handle([with_sender(native.bytes_of(one), _sender(one)) for one in found])

    def __enter__(self) -> DatagramLoop:
        if self._python.ring is not None:
            self._python.ring.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        if self._python.ring is not None:
            self._python.ring.__exit__()

    def run(self) -> None:
        """Handle datagrams until `stop` is called. Raises what a function of `open` raised, or `MemoryError`."""
        if self._core.library.rl_receive(ctypes.byref(self._bridge)):
            raise self._python.failure or MemoryError("for the datagrams of the native core")

    def stop(self, *, stopping: bool = True) -> None:
        """Make `run` return, with data on ``wake`` at once. With ``stopping`` false, let it run again."""
        self._bridge.stopping = stopping

    def counts(self) -> NativeCounts:
        """Return the counters."""
        published: Counter[str] = Counter()
        extra: Counter[str] = Counter()
        last: dict[str, float] = {}
        for handler, struct in zip(self._topics, self._topic_structs):
            if id(handler) in self._own:
                published[handler.route.name] += struct.published
                last[handler.route.name] = struct.published_at / 1e9
            else:
                extra[handler.route.topic] += struct.published
        return NativeCounts(
            self._bridge.received,
            published,
            last,
            extra,
            [destination.forwarded for destination in self._destination_structs],
        )

    def latencies(self) -> tuple[Sequence[int], float]:
        """Return the histogram of the handling times, and the sum of all times in seconds."""
        return self._bridge.latencies[: len(self._bounds) + 1], self._bridge.latency_sum


def _bits(places: Iterable[int]) -> Any:
    words = (ctypes.c_uint64 * 4)()
    for place in places:
        words[place // 64] |= 1 << place % 64
    return words


def _pacers(by_index: Mapping[int, int | None], count: int) -> Any:
    return (ctypes.c_void_p * count)(*(by_index.get(index) for index in range(count))) if by_index else None


def _bytes(datagrams: Any, count: int) -> list[bytes]:
    return [native.bytes_of(datagrams[index]) for index in range(count)]


def _address(struct: Source | None) -> int | None:
    return None if struct is None else ctypes.addressof(struct)


def _sender(datagram: native.Datagram) -> Sender:
    return sender_of(ctypes.string_at(datagram.sender, datagram.sender_size))
