"""The UDP side: a bound socket that a thread of its own empties.

Closing a UDP socket does not wake a receive that blocks on it (Linux), so the thread waits on the socket and on a
wake-up descriptor at once, and stopping drains what had arrived before it.
"""

from __future__ import annotations

import contextlib
import errno
import select
import socket
import struct
import sys
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any, Generic, NamedTuple, TypeVar

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.net import mmsg

_SO_RCVBUFFORCE = 33
_SO_MEMINFO = 55
_MEMINFO_DROPS = 8  # SK_MEMINFO_DROPS in linux/sock_diag.h
_DRAIN_S = 0.5
_SIGNAL_S = 0.2
"""How often whoever waits for the thread looks up. A signal that comes just before a wait begins does not end the wait,
and Python calls its handler only once the main thread runs again."""

_SLOTS = 64
"""Most datagrams that are read at once."""

BURST = 8
"""Most datagrams in a batch. They are published in one go, so it is below the ten messages that a ROS 2 subscription
keeps by default: a burst of ours never overruns one."""

Batch = list[bytes]
Sourced = tuple[bytes, bytes]
"""A datagram, and the IPv4 address that it comes from: four bytes."""

T = TypeVar("T")


def bind(address: str, port: int, receive_buffer: int) -> socket.socket:
    """A UDP socket that listens, with a receive buffer as near to ``receive_buffer`` bytes as the system lets it have.

    Raises `SetupError` that says which port cannot be had and why.
    """
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        _size_receive_buffer(sock, receive_buffer)
        sock.bind((address, port))
    except (OSError, UnicodeError) as error:
        sock.close()
        raise SetupError(_bind_failure(address, port, error)) from error
    return sock


def _bind_failure(address: str, port: int, error: OSError | UnicodeError) -> str:
    if not isinstance(error, OSError):
        return f"cannot listen on UDP port {port} of {address}: {error}"
    if error.errno == errno.EADDRINUSE:
        return f"UDP port {port} on {address} is in use by another program; stop it, or listen on another"
    return f"cannot listen on UDP port {port} of {address}: {error.strerror}"


def _size_receive_buffer(sock: socket.socket, size: int) -> None:
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, size)
    if sys.platform == "linux" and receive_buffer(sock) < size:
        # Beyond net.core.rmem_max, for those who may; others compare what they asked for with what they got.
        with contextlib.suppress(PermissionError):
            sock.setsockopt(socket.SOL_SOCKET, _SO_RCVBUFFORCE, size)


def receive_buffer(sock: socket.socket) -> int:
    """The size of the receive buffer in bytes, counted as it was asked for (Linux reports the double)."""
    size = sock.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
    return size // 2 if sys.platform == "linux" else size


class SocketState(NamedTuple):
    """How full a socket is, as the kernel counts; zeros where the system does not say."""

    waiting: int = 0
    """Bytes that wait, overhead included."""
    size: int = 0
    """Bytes that may wait at most."""
    drops: int = 0
    """Datagrams that the kernel dropped because there was no room."""


def socket_state(sock: socket.socket) -> SocketState:
    """How full a socket is; zeros of one that is closed."""
    if sys.platform != "linux":
        return SocketState()
    try:
        words = sock.getsockopt(socket.SOL_SOCKET, _SO_MEMINFO, 4 * (_MEMINFO_DROPS + 1))
    except OSError:
        return SocketState()
    counts = struct.unpack(f"{len(words) // 4}I", words)
    return SocketState(counts[0], counts[1], counts[_MEMINFO_DROPS])


def kernel_drops(sock: socket.socket) -> int:
    """Datagrams that the kernel dropped because the receive buffer was full; 0 where the system does not say."""
    return socket_state(sock).drops


def resolve(host: str, port: int) -> tuple[str, int]:
    """The IPv4 address of a host. Raises `SetupError` where the name does not resolve."""
    try:
        found = socket.getaddrinfo(host, port, socket.AF_INET, socket.SOCK_DGRAM)
    except (OSError, UnicodeError) as error:
        raise SetupError(f"the destination {host!r} does not resolve: {error}") from error
    address: tuple[str, int] = found[0][4]  # type: ignore[assignment]  # AF_INET was asked for
    return address


def reader(sock: socket.socket, size: int) -> Callable[[], Batch]:
    """A function that reads what has arrived and never waits.

    ``size`` is the longest datagram that is wanted, in bytes, and one more; longer ones come cut to it.
    """
    return mmsg.BatchReader(sock, size, _SLOTS).read if mmsg.AVAILABLE else OneByOneReader(sock, size, _SLOTS).read


def source_reader(sock: socket.socket, size: int) -> Callable[[], list[Sourced]]:
    """As `reader`; each datagram comes with the address of its sender."""
    if mmsg.AVAILABLE:
        return mmsg.SourceReader(sock, size, _SLOTS).read_with_sources
    return OneByOneReader(sock, size, _SLOTS).read_with_sources


class Receiver(Generic[T]):
    """The thread that empties a UDP socket, a batch at a time, into a function that must not wait for anybody.

    What arrives while the function works gathers in the kernel's buffer, so nothing is queued twice. A context
    manager: leaving it stops the thread, after the function was given everything that had arrived.
    """

    def __init__(
        self,
        sock: socket.socket,
        size: int,
        handle: Callable[[list[T]], None],
        reader: Callable[[socket.socket, int], Callable[[], list[Any]]] = reader,
    ) -> None:
        """``size`` is as that of `reader`; with `source_reader` the function is given addresses too."""
        self._sock = sock
        self._handle = handle
        self._read: Callable[[], list[T]] = reader(sock, size)
        self._wake, self._woken = socket.socketpair()
        self._wake.setblocking(False)
        self._stopping = False
        self.left = 0
        """Datagrams that had arrived when it stopped, and that there was no time to handle."""
        self._failure: BaseException | None = None
        self._thread = threading.Thread(target=self._run, name="udp-receive", daemon=True)

    def __enter__(self) -> Receiver[T]:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()
        self._thread.join()
        self._wake.close()
        self._woken.close()

    def stop(self) -> None:
        """Ask the thread to drain the socket and end. May be called from a signal handler, and more than once."""
        self._stopping = True
        with contextlib.suppress(OSError):  # it was told so often that no more fits, or it has ended
            self._wake.send(b"\0")

    def join(self) -> None:
        """Wait until the thread ends. Raises what the function raised, where that ended it."""
        while self._thread.is_alive():
            self._thread.join(_SIGNAL_S)
        if self._failure is not None:
            raise self._failure

    def _run(self) -> None:
        poll = select.poll()
        poll.register(self._sock, select.POLLIN)
        poll.register(self._woken, select.POLLIN)
        try:
            while not self._stopping:
                poll.poll()
                self._handle_burst()
            self._drain()
        except BaseException as failure:  # noqa: BLE001  # handed to whoever joins
            self._failure = failure

    def _handle_burst(self) -> None:
        """Handle what has arrived, and what arrives meanwhile."""
        more = True
        while more and not self._stopping:
            datagrams = self._read()
            more = len(datagrams) == _SLOTS
            self._handle_in_batches(datagrams)

    def _drain(self) -> None:
        """Handle what had arrived; a sender that goes on sending does not keep us."""
        deadline = time.monotonic() + _DRAIN_S
        while time.monotonic() < deadline and (datagrams := self._read()):
            self._handle_in_batches(datagrams)
        deadline = time.monotonic() + _DRAIN_S
        while time.monotonic() < deadline and (datagrams := self._read()):
            self.left += len(datagrams)

    def _handle_in_batches(self, datagrams: list[T]) -> None:
        for start in range(0, len(datagrams), BURST):
            self._handle(datagrams[start : start + BURST])


class OneByOneReader:
    """Reads what a UDP socket holds with the calls that every system has."""

    def __init__(self, sock: socket.socket, size: int, limit: int) -> None:
        self._sock, self._size, self._limit = sock, size, limit
        sock.setblocking(False)

    def read(self) -> Batch:
        """The datagrams that have arrived, oldest first, each cut to ``size`` bytes; empty where there are none."""
        return [datagram for datagram, _ in self._arrived()]

    def read_with_sources(self) -> list[Sourced]:
        """As `read`, with the addresses of the senders."""
        return [(datagram, socket.inet_aton(host)) for datagram, (host, _) in self._arrived()]

    def _arrived(self) -> Iterator[tuple[bytes, tuple[str, int]]]:
        with contextlib.suppress(BlockingIOError, InterruptedError):
            for _ in range(self._limit):
                yield self._sock.recvfrom(self._size)
