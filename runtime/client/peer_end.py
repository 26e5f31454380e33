"""Common part of `Peer` and `BlockingPeer`: opening, sending and repeating."""

from __future__ import annotations

import errno
import socket
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from roverlink.runtime.client.link_end import PERIOD_S, LinkEnd
from roverlink.runtime.client.repeating import Repetition, Schedule
from roverlink.runtime.client.session import ClosedError, Hook, Session, Traffic
from roverlink.runtime.client.signatures import Signatures
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.registry import EndName, Registry, load_registry
from roverlink.runtime.net import udp
from roverlink.runtime.net.carrier import Carrier
from roverlink.runtime.net.traffic_class import TrafficClass, mark
from roverlink.runtime.net.transports import transport_at
from roverlink.runtime.ros_arguments import parameters
from roverlink.transport_addresses import names_transport

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage

_RECEIVE_BUFFER = 1024 * 1024
_EVERY_ADDRESS = "0.0.0.0"  # noqa: S104  # the bridge is another machine, so loopback is not enough

E = TypeVar("E", bound="PeerEnd")


class PeerEnd(ABC):
    """Peer, or board of a peer, that a program of yours is. Not safe to use from several threads."""

    def __init__(
        self,
        session: Session,
        remote: tuple[str, int],
        local: tuple[str, int],
        signatures: Signatures | None = None,
    ) -> None:
        """Prepare the peer; it opens when its block is entered. Programs call `open` instead.

        ``remote`` is the host and the port of the bridge; ``local`` is an address of this computer and a port.
        ``signatures`` are among the hooks of the session.
        """
        self._signatures = signatures
        self._session, self._remote, self._local = session, remote, local
        self._schedule = Schedule()
        self._repeated: dict[str, Repetition] = {}
        self._socket: socket.socket | None = None
        self._carrier: Carrier | None = None

    @classmethod
    def open(
        cls: type[E],
        peer: str,
        *,
        board: str = "",
        registry: Registry | None = None,
        host: str = "127.0.0.1",
        port: int = int(parameters.LISTEN_PORT),
        local_address: str = _EVERY_ADDRESS,
        local_port: int | None = None,
        hooks: Sequence[Hook] = (),
        queue: int = 1000,
        key_files: Sequence[Path] = (),
        link: bool = True,
    ) -> E:
        """Return the peer ``peer`` of the table as a context manager; its socket is open inside the block.

        - ``board``: a board of the peer, if the program is this board alone. It sends the rows of this board. A program
          without it sends the rows of all boards.
        - ``registry``: the result of `load_registry`; by default that of the package ``generated`` on the import path.
        - ``host``, ``port``: the bridge. A host such as ``serial:/dev/ttyACM0`` or ``tcp:10.0.0.5:7000`` is a line to
          the bridge, so that the port means nothing.
        - ``local_address``, ``local_port``: where datagrams of the bridge arrive. The default port is that of the peer
          or board in the table; 0 takes any free port.
        - ``hooks``: steps that each datagram passes.
        - ``queue``: the largest number of payloads that wait for the program. More drop the oldest ones.
        - ``key_files``: copies of the key files with which the bridge signs the datagrams of this peer's link, if the
          table says that the peer must sign.
        - ``link``: exchange link messages with the bridge, if the table has them. See `link`.

        Raises `SetupError` for an unknown peer or board, or if a key is missing, and `RegistryError` if there is no
        generated code. Entering the block raises `SetupError` if the host does not resolve or the port is in use. It
        waits up to two seconds for the connection of a line; without one, `send` raises `OSError` until there is one.
        """
        registry = registry or load_registry()
        end = EndName(peer, board)
        signatures = Signatures(registry, end, key_files) if key_files else None
        session = Session(registry, end, [*hooks, *filter(None, [signatures])], queue, link)
        if session.peer.must_sign and signatures is None:
            raise SetupError(f"the peer {peer!r} must sign (table key `sign`), but no key file is given")
        # Boards without an address of their own listen on the port of their peer.
        local = registry.ends.get(end, session.peer).port if local_port is None else local_port
        return cls(session, (host, port), (local_address, local), signatures)

    @property
    def port(self) -> int:
        """UDP port on which the peer receives."""
        port: int = self._opened().getsockname()[1]
        return port

    @property
    def remote(self) -> str:
        """Address to which the peer sends, as ``HOST:PORT``, or the address of its line."""
        return self._carrier.name if self._carrier is not None else f"{self._remote[0]}:{self._remote[1]}"

    @property
    def traffic(self) -> Traffic:
        """Counters of sent, received and dropped datagrams."""
        return self._session.traffic

    @property
    def link(self) -> LinkEnd | None:
        """Result of the link messages: statistics of the link, and the rows of which the bridge has another schema.

        None if the table has no link message.
        """
        return self._session.link

    def send(self, payload: ProtoMessage, row: str | None = None) -> None:
        """Send a payload to the bridge. If its row is repeated, this payload is repeated from now on.

        ``row`` is the name of the row; it is needed only if several rows of the peer have this type of payload.

        Raises `SetupError` if no row carries this payload from this peer, `ConversionError` if a field that proto2
        requires is not set, `ClosedError` if the peer is not open, and `OSError` if the network refuses the datagram.
        """
        name = self._session.row_of(payload, row).route.name
        datagram = self._session.wrap(payload, name)
        if repetition := self._repeated.get(name):
            repetition.make = lambda: datagram
        self.send_datagram(datagram)

    def send_datagram(self, datagram: bytes) -> None:
        """Send bytes to the bridge, whatever they contain; the hooks apply. For tools that test a bridge.

        Raises `ClosedError` if the peer is not open, and `OSError` if the network refuses the datagram, or if its line
        has no connection.
        """
        if self._carrier is not None and self._carrier.why is not None:
            raise OSError(errno.ENOTCONN, self._carrier.why)
        self._opened().sendto(self._session.outgoing(datagram), self._remote)
        self._session.traffic.sent += 1

    def repeat(self, payload: ProtoMessage, row: str | None = None, *, rate: float) -> Repetition:
        """Send a payload now and then ``rate`` times a second, until it is stopped, replaced, or the peer is closed.

        The next `send` or `repeat` of the same row replaces the payload. Refused datagrams are counted, because a later
        one may get through. Raises the errors of `send`, but no `OSError`.
        """
        name = self._session.row_of(payload, row).route.name
        datagram = self._session.wrap(payload, name)
        if before := self._repeated.get(name):
            before.stop()
        self._repeated[name] = self.send_every(1 / rate, lambda: datagram)
        return self._repeated[name]

    def send_every(self, interval: float, make: Callable[[], bytes]) -> Repetition:
        """Send the datagram that ``make`` returns now and then every ``interval`` seconds; the hooks apply."""
        self._opened()
        repetition = Repetition(make, interval, time.monotonic())
        self._schedule.add(repetition)
        self._send_due()
        return repetition

    def _send_due(self) -> None:
        """Send the repeated datagrams that are due."""
        try:
            for datagram in self._schedule.take_due(time.monotonic()):
                try:
                    self.send_datagram(datagram)
                except OSError:
                    self._session.traffic.unsent += 1
        finally:
            self._wait_for_due()

    @abstractmethod
    def _wait_for_due(self) -> None:
        """Arrange that `_send_due` is called when the next repeated datagram is due."""

    def _opened(self) -> socket.socket:
        """Return the socket. Raises `ClosedError` if the peer is not open."""
        if self._socket is None:
            raise ClosedError(f"{self._session.end} is not open; use it inside its `with` block")
        return self._socket

    def _start(self) -> None:
        """Start what runs while the peer is open: the storing of timestamps, and the link messages."""
        if self._signatures is not None:
            self._signatures.__enter__()
        if (link := self._session.link) is not None:
            self.send_every(PERIOD_S, link.write)

    def _forget_socket(self) -> None:
        """End the repetitions; from now on the peer is not open."""
        if self._signatures is not None:
            self._signatures.__exit__()
        if self._carrier is not None:
            self._carrier.close()
        self._socket = None
        self._schedule = Schedule()
        self._repeated.clear()

    def _bind(self) -> socket.socket:
        """Bind the peer's socket. The address of the bridge must be known."""
        address, port = self._local
        if names_transport(line := self._remote[0]):
            self._socket = udp.bind("127.0.0.1", 0, _RECEIVE_BUFFER)
            self._carrier = Carrier(transport_at(line), self._socket)
            self._carrier.start()
            self._remote = self._carrier.address[:2]
            return self._socket
        if address == _EVERY_ADDRESS and ":" in self._remote[0]:
            address = "::"
        self._socket = udp.bind(address, port, _RECEIVE_BUFFER)
        mark(self._socket, TrafficClass.COMMANDS)
        return self._socket
