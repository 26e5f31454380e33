"""Carrier between a UDP socket of this program and an end that has another transport than UDP.

The program sends the end's datagrams to `Carrier.address`, a UDP socket on the loopback interface, and the end's
datagrams come from there. So all that the program does with datagrams is the same for every transport. Two threads do
the work: one connects, receives, and connects again when the line is gone; the other one sends.
"""

from __future__ import annotations

import contextlib
import math
import select
import socket
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from itertools import islice
from typing import NamedTuple

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.net import udp
from roverlink.runtime.net.hosts import SocketAddress
from roverlink.runtime.net.outbox import Outbox, Undelivered
from roverlink.runtime.net.transports import Connection, NotTakenError, Transport, transport_at
from roverlink.transport_addresses import names_transport

_BUFFER = 1024 * 1024  # bytes that the program may send while the line is busy
_MOST_BATCHES = 16
_WAIT_S = 0.2
"""Longest wait in seconds for datagrams of the end, after which the thread looks whether it has to end."""
_FIRST_PAUSE_S, _LONGEST_PAUSE_S = 0.1, 2.0
_LOOK_S = 0.01
_DRAIN_S = 0.5
"""Longest time in seconds to send what waits when the carrier is closed, such as the stops."""
_NOT_YET = "not connected yet"
_LOOPBACK = {socket.AF_INET: "127.0.0.1", socket.AF_INET6: "::1"}
_EVERYWHERE = ("0.0.0.0", "::")  # noqa: S104  # addresses of sockets that other modules have bound

Report = Callable[[str], None]
"""Function that gets the reason why there is no connection any more, or none yet; empty if there is one again."""


class Outgoing:
    """Thread that takes what a program sends to a UDP socket, and sends it through an outbox over a line."""

    def __init__(self, sock: socket.socket, send: Callable[[bytes], None], outbox: Outbox[bytes]) -> None:
        """Prepare the thread. ``send`` blocks while the line is busy, and raises `OSError` if there is none."""
        self._socket, self._send, self._outbox = sock, send, outbox
        self._read = udp.reader(sock, udp.LARGEST)
        self._wake, self._woken = socket.socketpair()
        self._deadline = math.inf
        self._thread = threading.Thread(target=self._run, name="carrier-send", daemon=True)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def close(self) -> None:
        """Send what waits, but not longer than half a second, and end the thread."""
        self._deadline = time.monotonic() + _DRAIN_S
        self._wake.send(b"\0")
        self._thread.join(2 * _DRAIN_S)  # a line that hangs ends with the connection
        self._wake.close()

    def _run(self) -> None:
        poll = select.poll()
        poll.register(self._socket, select.POLLIN)
        poll.register(self._woken, select.POLLIN)
        with self._woken:
            while self._deadline == math.inf:
                wait = self._outbox.next_due - time.monotonic()
                poll.poll(None if wait == math.inf else max(0, math.ceil(wait * 1000)))
                self._send_due()
            with contextlib.suppress(OSError):  # the line has hung for so long that the socket is closed
                self._take_in(time.monotonic())
            self._outbox.discard()

    def _send_due(self) -> None:
        while (now := time.monotonic()) < self._deadline:
            # What has arrived meanwhile comes first into the outbox, which decides what goes next.
            self._take_in(now)
            if (due := self._outbox.take(now)) is None:
                return
            try:
                self._send(due)
            except OSError:
                self._outbox.undelivered[Undelivered.NOT_CONNECTED.value] += 1

    def _take_in(self, now: float) -> None:
        # A flood must not keep the thread from sending.
        for datagrams in islice(iter(self._read, []), _MOST_BATCHES):
            for datagram in datagrams:
                self._outbox.put(datagram, now)


class Carrier:
    """Carrier between a UDP socket of this program and an end with another transport."""

    def __init__(
        self,
        transport: Transport,
        program: socket.socket,
        report: Report = lambda _: None,
        outbox: Outbox[bytes] | None = None,
        sign: Callable[[bytes], bytes] | None = None,
    ) -> None:
        """Carry between ``transport`` and the bound UDP socket of the program.

        ``report`` gets each change of the connection. ``outbox`` decides which datagram goes next.
        ``sign`` gets each when it leaves, and signs it: what is signed may not be overtaken any more.
        """
        self._transport, self._report, self._sign = transport, report, sign
        self._outbox = outbox or Outbox[bytes]()
        self._program = _reachable(program)
        self._socket = udp.bind(_LOOPBACK[program.family], 0, _BUFFER)
        self._outgoing = Outgoing(self._socket, self._send, self._outbox)
        self._incoming = threading.Thread(target=self._run, name="carrier-receive", daemon=True)
        self._connection: Connection | None = None
        self._line = threading.Lock()  # nobody closes a connection while the other thread sends over it
        self._broken: OSError | None = None
        self._closed = False
        self._refused = self._lost = 0
        self.why: str | None = _NOT_YET
        """Reason why there is no connection; None if there is one."""

    @property
    def name(self) -> str:
        """Address of the end, as the user has written it."""
        return self._transport.name

    @property
    def address(self) -> SocketAddress:
        """Address to which the program sends the end's datagrams, and from which those of the end come."""
        address: SocketAddress = self._socket.getsockname()
        return address

    @property
    def damaged(self) -> int:
        """Frames of the end that were damaged on the line."""
        connection = self._connection
        return self._refused + (connection.refused if connection is not None else 0)

    @property
    def undelivered(self) -> Counter[str]:
        """Datagrams of the program that were not sent over the line, by reason (`Undelivered`)."""
        lost = max(self._lost, udp.kernel_drops(self._socket))  # 0 for a socket that is closed
        return self._outbox.undelivered + Counter({Undelivered.OVERFLOW.value: lost})

    def start(self) -> None:
        """Start to connect."""
        self._incoming.start()
        self._outgoing.start()

    def wait(self, seconds: float = _LONGEST_PAUSE_S) -> None:
        """Wait until there is a connection, but not longer than a number of seconds."""
        until = time.monotonic() + seconds
        while self.why is not None and time.monotonic() < until:
            time.sleep(_LOOK_S)

    def close(self) -> None:
        """Send what waits, and close the line."""
        self._outgoing.close()
        self._closed = True
        self._incoming.join(2 * _WAIT_S)  # nobody has to wait for an attempt to connect
        self._transport.close()
        self._lost = udp.kernel_drops(self._socket)
        self._socket.close()

    def _run(self) -> None:
        pause = _FIRST_PAUSE_S
        while not self._closed:
            try:
                self._connection = connection = self._transport.connect()
                self._tell(None)
                pause = _FIRST_PAUSE_S
                self._receive(connection)
            except OSError as error:
                self._tell(str(error.strerror or error))
            self._disconnect()
            self._sleep(pause)
            pause = min(2 * pause, _LONGEST_PAUSE_S)

    def _receive(self, connection: Connection) -> None:
        while not self._closed:
            for datagram in connection.receive(_WAIT_S):
                with contextlib.suppress(BlockingIOError):
                    self._socket.sendto(datagram, self._program)
            if (broken := self._broken) is not None:
                raise broken

    def _disconnect(self) -> None:
        with self._line:
            connection, self._connection, self._broken = self._connection, None, None
            if connection is not None:
                self._refused += connection.refused
                connection.close()

    def _tell(self, why: str | None) -> None:
        before, self.why = self.why, why
        # Without a connection, the reason may change with each attempt, such as "nobody has connected".
        is_news = (before is None) != (why is None) or before is _NOT_YET
        if is_news and not self._closed:
            self._report(why or "")

    def _sleep(self, seconds: float) -> None:
        until = time.monotonic() + seconds
        while not self._closed and time.monotonic() < until:
            time.sleep(_FIRST_PAUSE_S)

    def _send(self, datagram: bytes) -> None:
        with self._line:
            connection = self._connection
            if connection is None or self._broken is not None:
                raise ConnectionError(self.why)
            datagram = self._sign(datagram) if self._sign is not None else datagram
            if len(datagram) > self._transport.largest:
                self._outbox.undelivered[Undelivered.TOO_LARGE.value] += 1
                return
            try:
                connection.send(datagram)
            except NotTakenError:
                self._outbox.undelivered[Undelivered.NOT_TAKEN.value] += 1
            except OSError as error:
                self._broken = error  # the other thread connects again
                raise


@contextlib.contextmanager
def line_at(text: str, report: Report = lambda _: None) -> Iterator[tuple[socket.socket, Carrier]]:
    """Yield the socket at which the datagrams of a line arrive, and the carrier, which has started to connect.

    ``report`` gets each change of the connection.
    """
    with udp.bind(_LOOPBACK[socket.AF_INET], 0, _BUFFER) as sock:
        carrier = Carrier(transport_at(text), sock, report)
        carrier.start()
        try:
            yield sock, carrier
        finally:
            carrier.close()


class Way(NamedTuple):
    """Way of datagrams to an end."""

    address: tuple[str, int]
    """IP address and port to which datagrams for the end go."""
    socket: socket.socket | None
    """Socket at which the datagrams of the end arrive, if it has a line."""


@contextlib.contextmanager
def way_to(text: str, lost: Callable[[Counter[str]], None]) -> Iterator[Way]:
    """Yield the way for ``text``: ``HOST:PORT``, or the address of a line.

    At the end, ``lost`` gets the number of datagrams that were not sent over the line, by reason, if there are any.
    Raises `SetupError` if the text has another form, or if there is no connection.
    """
    if not names_transport(text):
        yield Way(udp.destination_of(text), None)
        return
    with line_at(text) as (sock, carrier):
        carrier.wait()
        if carrier.why is not None:
            raise SetupError(f"no connection over {text}: {carrier.why}")
        yield Way(carrier.address[:2], sock)
    if undelivered := +carrier.undelivered:
        lost(undelivered)


def _reachable(sock: socket.socket) -> SocketAddress:
    """Return the address at which a socket of this computer gets datagrams."""
    host, *rest = sock.getsockname()
    return (_LOOPBACK[sock.family] if host in _EVERYWHERE else host, *rest)
