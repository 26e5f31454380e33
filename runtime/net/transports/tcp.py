"""TCP: datagrams behind their lengths, as protobuf's ``parseDelimitedFrom`` reads them.

TCP delivers late what UDP would lose, and a late command is worse than none. So the kernel holds little that is not
sent yet, and a connection whose data is not confirmed for two seconds is aborted with all that it holds.
"""

from __future__ import annotations

import contextlib
import errno
import os
import select
import socket
import struct
import sys

from roverlink.runtime.net.traffic_class import TrafficClass, mark
from roverlink.runtime.net.transports import Connection
from roverlink.runtime.net.transports.framing import DelimitedReader, delimited
from roverlink.transport_addresses import KINDS, TransportAddress

_CONNECT_S = 2.0
_ACCEPT_S = 0.5
_HANGS_S = 2.0
"""Time in seconds after which data that is not confirmed, or not taken, ends the connection."""
_SEND_BUFFER = 16_384  # bytes, which the kernel holds at most until they are confirmed
_CHUNK = 65_536
_ABORT = struct.pack("ii", 1, 0)  # struct linger (socket(7)): discard what is not sent


class TcpTransport:
    """TCP connection to an address, or with the option ``listen`` the newest connection from anywhere to an address."""

    largest = KINDS["tcp"].largest

    def __init__(self, name: str, address: TransportAddress) -> None:
        self.name = name
        host, _, port = address.place.rpartition(":")
        self._host, self._port = host.strip("[]"), int(port)
        self._listens = "listen" in address.options
        self._listener: socket.socket | None = None

    def connect(self) -> Connection:
        """Connect within two seconds, or wait half a second for a connection."""
        if not self._listens:
            try:
                sock = socket.create_connection((self._host, self._port), _CONNECT_S)
            except UnicodeError as error:
                raise OSError(str(error)) from error
            if sock.getsockname() == sock.getpeername():  # a port of this computer on which nobody listens was its own
                sock.close()
                raise ConnectionRefusedError(errno.ECONNREFUSED, os.strerror(errno.ECONNREFUSED))
            return TcpConnection(sock, self.largest)
        if self._listener is None:
            family = socket.AF_INET6 if ":" in self._host else socket.AF_INET
            dual = self._host == "::"
            self._listener = socket.create_server((self._host, self._port), family=family, dualstack_ipv6=dual)
        self._listener.settimeout(_ACCEPT_S)
        try:
            sock, _ = self._listener.accept()
        except TimeoutError:
            raise TimeoutError(f"nobody has connected to TCP port {self._port}") from None
        return TcpConnection(sock, self.largest, self._listener)

    def close(self) -> None:
        """Accept no more connections."""
        if self._listener is not None:
            self._listener.close()


class TcpConnection:
    """TCP connection, which a newer one replaces if there is a ``listener``."""

    def __init__(self, sock: socket.socket, largest: int, listener: socket.socket | None = None) -> None:
        self.refused = 0
        self._socket, self._listener = sock, listener
        self._reader = DelimitedReader(largest)
        _set_up(sock)
        self._readable, self._writable = select.poll(), select.poll()
        self._readable.register(sock, select.POLLIN)
        self._writable.register(sock, select.POLLOUT)
        if listener is not None:
            self._readable.register(listener, select.POLLIN)

    def receive(self, timeout: float) -> list[bytes]:
        """Return the datagrams that have arrived; wait at most ``timeout`` seconds for bytes."""
        ready = {found for found, _ in self._readable.poll(timeout * 1000)}
        if self._listener is not None and self._listener.fileno() in ready:
            raise ConnectionResetError("a newer connection replaces this one")
        if self._socket.fileno() not in ready:
            return []
        if not (received := self._socket.recv(_CHUNK)):
            raise ConnectionResetError("the other side has closed the connection")
        try:
            return self._reader.take(received)
        except ValueError as error:
            self.refused += 1
            raise ConnectionError(str(error)) from error

    def send(self, datagram: bytes) -> None:
        """Send a datagram as soon as all before it have left this computer."""
        if self._writable.poll(_HANGS_S * 1000):
            with contextlib.suppress(TimeoutError):
                self._socket.sendall(delimited(datagram))
                return
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _ABORT)
        raise TimeoutError("the other side takes no data")

    def close(self) -> None:
        """Close the connection."""
        self._socket.close()


def _set_up(sock: socket.socket) -> None:
    sock.settimeout(_HANGS_S)
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _SEND_BUFFER)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    mark(sock, TrafficClass.COMMANDS)
    if sys.platform == "linux":
        # A cable that was pulled is noticed after 1 + 3 * 1 seconds without any data, and after two with data.
        for option, value in (
            (socket.TCP_KEEPIDLE, 1),
            (socket.TCP_KEEPINTVL, 1),
            (socket.TCP_KEEPCNT, 3),
            (socket.TCP_USER_TIMEOUT, int(_HANGS_S * 1000)),
            (socket.TCP_NOTSENT_LOWAT, 1),
        ):
            sock.setsockopt(socket.IPPROTO_TCP, option, value)
