"""Conversation of a peer with a bridge, without sockets and clock: payloads to datagrams, and datagrams to payloads.

Between the socket and the payloads, each datagram passes the hooks. An outgoing datagram passes them from the first to
the last, and an incoming one from the last to the first. So a hook that signs has to be the last one.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from roverlink.runtime.client.link_end import LinkEnd
from roverlink.runtime.client.pending_requests import Requests
from roverlink.runtime.core.errors import DatagramError, Reason, RoverlinkError, SetupError, nearest
from roverlink.runtime.core.registry import AnyHandler, EndName, Registry
from roverlink.runtime.core.repeater import Fate
from roverlink.runtime.core.translator import Translator

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage


class ClosedError(RoverlinkError):
    """Use of a peer that is closed, or not open yet."""


class Received(NamedTuple):
    """Payload that has arrived, with its number in the envelope."""

    number: int
    payload: ProtoMessage


class Hook(Protocol):
    """Step between the socket and the payloads that each datagram of a peer passes, such as signing.

    A hook can also send datagrams of its own: see the method ``send_every`` of the peers.
    """

    def outgoing(self, datagram: bytes) -> bytes:
        """Return the datagram to send in place of ``datagram``."""

    def incoming(self, datagram: bytes) -> bytes | None:
        """Return the datagram to read in place of ``datagram``, or None if the program must not get it.

        Raises `DatagramError` to refuse the datagram; it is then counted by the error's reason.
        """


@dataclass
class Traffic:
    """Counters of a peer. Nothing disappears uncounted."""

    sent: int = 0
    """Datagrams sent."""
    unsent: int = 0
    """Datagrams of repetitions that the network refused."""
    received: int = 0
    """Datagrams received."""
    consumed: int = 0
    """Received link messages, responses to requests, and datagrams that a hook has kept for itself."""
    dropped: Counter[str] = field(default_factory=Counter)
    """Received datagrams without a payload that can be read or is of use, by reason, such as ``malformed``."""
    overflowed: int = 0
    """Payloads that were dropped because the program takes them too slowly. The oldest ones are dropped."""


class Session:
    """Conversation of one peer, or of one board of a peer, with a bridge."""

    def __init__(
        self, registry: Registry, end: EndName, hooks: Sequence[Hook] = (), queue: int = 1000, link: bool = False
    ) -> None:
        """Speak for the peer or board ``end``. At most ``queue`` payloads wait for the program.

        With ``link``, link messages are exchanged with the bridge if the table has them. Raises `SetupError` if the
        table has no such peer or board.
        """
        self.peer, self.end = registry.peer(end.peer), end
        boards = registry.boards_of(end.peer)
        if end.board and end.board not in boards:
            known = nearest(end.board, boards) if boards else f"{end.peer} has no boards"
            raise SetupError(f"unknown board {end.board!r}; {known}")
        self.traffic = Traffic()
        self._registry, self._hooks = registry, tuple(hooks)
        self._translator = Translator(registry)
        self._arrived: deque[Received] = deque(maxlen=queue)
        self.link = LinkEnd(registry, end) if link and registry.link is not None else None
        """Exchange of link messages; None if there is none."""
        self.requests = Requests(registry, end)
        """Requests in both directions."""

    # --- sending ---

    def row_of(self, payload: ProtoMessage, row: str | None = None) -> AnyHandler:
        """Return the handler of the row that carries a payload from this peer; ``row`` is the row's name.

        The name is needed only if several rows of the peer have this type of payload. Raises `SetupError` if no row
        fits, or several.
        """
        if row is not None:
            return self._named(payload, row)
        of_type = [handler for handler in self._registry.handlers if handler.payload_type is type(payload)]
        mine = [handler for handler in of_type if self._sends(handler)]
        if len(mine) == 1:
            return mine[0]
        type_name = payload.DESCRIPTOR.full_name
        if mine:
            names = ", ".join(handler.route.name for handler in mine)
            raise SetupError(f"several rows have the payload {type_name}: {names}; name one with row=")
        if of_type:
            raise self._cannot_send(of_type[0])
        raise SetupError(f"no row of the table has the payload {type_name}")

    def wrap(self, payload: ProtoMessage, row: str | None = None) -> bytes:
        """Return the datagram with a payload, before the hooks. Raises the errors of `row_of` and `ConversionError`."""
        handler = self.row_of(payload, row)
        datagram = self._registry.datagram(handler.route.name, payload)
        self.requests.store(handler, payload, datagram)
        return datagram

    def outgoing(self, datagram: bytes) -> bytes:
        """Return the bytes to send for a datagram. Send them at once and in order: they may contain a timestamp."""
        if self.link is not None:
            self.link.count_sent(datagram)
        for hook in self._hooks:
            datagram = hook.outgoing(datagram)
        return datagram

    def _named(self, payload: ProtoMessage, row: str) -> AnyHandler:
        handler = self._registry.by_name.get(row)
        if handler is None:
            raise SetupError(f"unknown row {row!r}; {nearest(row, self._registry.by_name)}")
        if not self._sends(handler):
            raise self._cannot_send(handler)
        if type(payload) is not handler.payload_type:
            wanted, given = handler.payload_type.DESCRIPTOR.full_name, payload.DESCRIPTOR.full_name
            raise SetupError(f"the row {row!r} has the payload {wanted}, not {given}")
        return handler

    def _sends(self, handler: AnyHandler) -> bool:
        route = handler.route
        return route.inbound and route.peer == self.end.peer and self.end.board in ("", route.board)

    def _cannot_send(self, handler: AnyHandler) -> SetupError:
        route = handler.route
        if route.inbound and route.peer == self.end.peer:
            owner = f"{route.board} sends it" if route.board else f"no board sends it, but {route.peer} as a whole"
            return SetupError(f"{self.end} cannot send {route.name}: {owner}")
        return SetupError(f"{self.end} cannot send {route.name}: the row's direction is {route.direction}")

    # --- receiving ---

    def take_in(self, datagram: bytes, now: float) -> None:
        """Count a datagram that has arrived, and queue its payload for `take`, or give it to who waits for it."""
        self.traffic.received += 1
        try:
            received = self._read(datagram)
        except DatagramError as error:
            self.traffic.dropped[error.reason.value] += 1
            return
        fate = None if received is None else self.requests.take(*received, now)
        if received is None or fate is None:
            self.traffic.consumed += 1
            return
        if fate is Fate.REPEATED:
            self.traffic.dropped[Reason.REPEATED.value] += 1
            return
        self.traffic.overflowed += len(self._arrived) == self._arrived.maxlen
        self._arrived.append(received)

    def take(self, payload_type: type[Any] | None = None) -> Received | None:
        """Return the oldest payload that waits, or None. With ``payload_type``, payloads of other types stay."""
        for index, received in enumerate(self._arrived):
            if payload_type is None or isinstance(received.payload, payload_type):
                del self._arrived[index]
                return received
        return None

    def _read(self, datagram: bytes) -> Received | None:
        for hook in reversed(self._hooks):
            passed = hook.incoming(datagram)
            if passed is None:
                return None
            datagram = passed
        received = Received(*self._translator.payload(datagram))
        if self.link is None:
            return received
        if received.number == self.link.number:
            self.link.take(received.payload)
            return None
        self.link.count_received()
        return received
