"""UDP reception: a bound socket and the thread that reads it.

On Linux, closing a UDP socket does not wake a thread that is blocked on it. So the thread polls the socket and a second
socket, which is only used to wake the thread. When the thread stops, it first handles the datagrams that have arrived.
"""

from __future__ import annotations

import contextlib
import errno
import select
import signal
import socket
import struct
import sys
import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

from roverlink.runtime.core.errors import FailedThreadError, SetupError
from roverlink.runtime.net import hosts
from roverlink.runtime.net.hosts import Sender, sender_at

_SO_RCVBUFFORCE = 33  # asm-generic/socket.h
_SO_MEMINFO = 55  # asm-generic/socket.h
_MEMINFO_DROPS = 8  # SK_MEMINFO_DROPS in linux/sock_diag.h
_DRAIN_S = 0.5  # longest time to handle datagrams after the stop
_SLOTS = 64
"""Largest number of datagrams that are read before they are handled."""

LARGEST = 65_536
"""Size in bytes that no datagram exceeds."""

BURST = 8
"""Largest number of datagrams in a batch.

A batch is published at once. Eight is below the default depth (10) of a ROS 2 subscription, so that one batch cannot
overflow its queue.
"""

Batch = list[bytes]
SentDatagram = tuple[bytes, Sender]
"""A datagram with its sender's address and port."""

T = TypeVar("T")


def bind(address: str, port: int, receive_buffer: int, setting: str = "") -> socket.socket:
    """Return a bound UDP socket whose receive buffer is as near to ``receive_buffer`` bytes as the system allows.

    With the address ``::``, it receives IPv4 and IPv6. Raises `SetupError` with port and cause if the socket cannot be
    bound; ``setting`` tells the user there what sets the port.
    """
    try:
        sock = socket.socket(socket.AF_INET6 if ":" in address else socket.AF_INET, socket.SOCK_DGRAM)
    except OSError as error:  # a system without IPv6
        raise SetupError(_bind_failure(address, port, error, setting)) from error
    try:
        if sock.family == socket.AF_INET6:
            sock.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 0)  # the default depends on the system
        # Before bind(), so that no datagram arrives while the buffer is still small.
        size_receive_buffer(sock, receive_buffer)
        sock.bind((address, port))
    except (OSError, UnicodeError) as error:
        sock.close()
        raise SetupError(_bind_failure(address, port, error, setting)) from error
    return sock


def _bind_failure(address: str, port: int, error: OSError | UnicodeError, setting: str) -> str:
    if not isinstance(error, OSError):
        return f"cannot listen on UDP port {port} of {address}: {error}"
    if error.errno == errno.EADDRINUSE:
        other = f"choose another port{f' ({setting})' if setting else ''}"
        return f"UDP port {port} on {address} is in use by another program; stop that program or {other}"
    return f"cannot listen on UDP port {port} of {address}: {error.strerror}"


def size_receive_buffer(sock: socket.socket, size: int) -> None:
    """Make the receive buffer of a socket as near to ``size`` bytes as the system allows."""
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, size)
    if sys.platform == "linux" and receive_buffer(sock) < size:
        # SO_RCVBUFFORCE exceeds net.core.rmem_max but needs CAP_NET_ADMIN. Others get a warning about the difference.
        with contextlib.suppress(PermissionError):
            sock.setsockopt(socket.SOL_SOCKET, _SO_RCVBUFFORCE, size)


def receive_buffer(sock: socket.socket) -> int:
    """Return the size of a socket's receive buffer in bytes, in the unit in which a program requests it.

    Linux reports twice the requested size, because it adds room for its own data about the datagrams (socket(7)).
    """
    size = sock.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
    return size // 2 if sys.platform == "linux" else size


class SocketState(NamedTuple):
    """Fill level of a socket's receive buffer, counted by the kernel.

    All numbers are zero if the system does not report them.
    """

    waiting: int = 0
    """Bytes used in the buffer, including the kernel's own data about the datagrams."""
    size: int = 0
    """Size of the buffer in bytes."""
    drops: int = 0
    """Datagrams dropped because the buffer was full."""


def socket_state(sock: socket.socket) -> SocketState:
    """Return the fill level of a socket's receive buffer; all numbers are zero if the socket is closed."""
    if sys.platform != "linux":
        return SocketState()
    try:
        words = sock.getsockopt(socket.SOL_SOCKET, _SO_MEMINFO, 4 * (_MEMINFO_DROPS + 1))
    except OSError:
        return SocketState()
    # The kernel copies the counters that it has. Old kernels and emulators have fewer; theirs are 0.
    counts = struct.unpack(f"{_MEMINFO_DROPS + 1}I", words.ljust(4 * (_MEMINFO_DROPS + 1), b"\0"))
    return SocketState(counts[0], counts[1], counts[_MEMINFO_DROPS])


def kernel_drops(sock: socket.socket) -> int:
    """Return how many datagrams the kernel has dropped because a socket's receive buffer was full.

    Returns 0 if the system does not report the number.
    """
    return socket_state(sock).drops


def resolve(host: str, port: int) -> tuple[str, int]:
    """Return the IPv4 address of a host, or else its IPv6 address, with the port.

    Raises `SetupError` if the name does not resolve.
    """
    try:
        # Names are resolved once, at the start: a lookup can block for seconds.
        found = hosts.look_up(host, port)
    except (OSError, UnicodeError) as error:
        raise SetupError(
            f"the destination {host!r} does not resolve to an IP address: {hosts.reason_of(error)}"
        ) from error
    # `localhost` is ::1 first, where a bridge that listens on 0.0.0.0 hears nothing.
    return min(found, key=lambda address: hosts.family_of(address) != socket.AF_INET)[0], port


def destination_of(text: str) -> tuple[str, int]:
    """Return the IPv4 address and the port for a text ``HOST:PORT``, such as ``rover.local:5000``.

    Raises `SetupError` if the text has another form or the host does not resolve.
    """
    host, separator, port = text.rpartition(":")
    if not separator or not host or not port.isdecimal() or not 0 < int(port) < 65_536:
        raise SetupError(f"{text!r} is not of the form HOST:PORT, such as 127.0.0.1:5000")
    return resolve(host, int(port))


def reader(sock: socket.socket, size: int) -> Callable[[], Batch]:
    """Return a function that reads the datagrams that have arrived at a socket, oldest first, without blocking.

    ``size`` is one byte more than the longest allowed datagram. Longer datagrams are cut to ``size`` bytes.
    """
    return partial(_arrived, partial(sock.recv, size, socket.MSG_DONTWAIT))


def sender_reader(sock: socket.socket, size: int) -> Callable[[], list[SentDatagram]]:
    """Return a function that reads datagrams like the function from `reader`, each with its sender."""
    receive = partial(sock.recvfrom, size, socket.MSG_DONTWAIT)
    return lambda: [(datagram, sender_at(address)) for datagram, address in _arrived(receive)]


def _arrived(receive: Callable[[], T]) -> list[T]:
    # One call of recvmmsg for many datagrams would save half a microsecond for each of them, but to handle one in
    # Python takes twenty times as long. The native core does use it.
    arrived: list[T] = []
    with contextlib.suppress(BlockingIOError):
        while len(arrived) < _SLOTS:
            arrived.append(receive())
    return arrived


class Loop(Protocol):
    """Something that reads the socket of a `Receiver` in its place, on its thread."""

    def run(self) -> None:
        """Handle datagrams until `stop` is called."""

    def stop(self, *, stopping: bool = True) -> None:
        """Make `run` return when data comes on the second of the `Receiver`'s sockets; false undoes it."""


class Receiver(Generic[T]):
    """Thread that reads a UDP socket and calls a function with each batch of datagrams. The function must not block.

    Datagrams that arrive while the function runs wait in the kernel's buffer, so there is no second queue. A context
    manager: on exit the thread handles the datagrams that have arrived, and then stops.
    """

    def __init__(
        self,
        sock: socket.socket,
        size: int,
        handle: Callable[[list[T]], None],
        reader: Callable[[socket.socket, int], Callable[[], list[Any]]] = reader,
    ) -> None:
        """Prepare the thread, which calls ``handle`` with each batch.

        ``size`` is one byte more than the longest allowed datagram. ``reader`` is the function `reader`; if it is
        `sender_reader`, a batch contains the senders, too.
        """
        self._sock = sock
        self._size = size
        self.pass_to(handle, reader)
        self._wake, self._woken = socket.socketpair()
        self._wake.setblocking(False)
        self._woken.setblocking(False)
        self._stopping = self._has_ended = False
        self._tell_end: Callable[[], object] = lambda: None
        self._loop: Loop | None = None
        self.left = 0
        """Datagrams that had arrived at the stop but were not handled in time."""
        self._rounds = 0
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

    def pass_to(
        self,
        handle: Callable[[list[T]], None],
        reader: Callable[[socket.socket, int], Callable[[], list[Any]]] = reader,
    ) -> None:
        """Pass the batches that ``reader`` reads to ``handle``, from the next batch on. Safe while the thread runs."""
        # One assignment, because a reader's batches must reach only the handler that they are for.
        self._path: tuple[Callable[[], list[T]], Callable[[list[T]], None]] = reader(self._sock, self._size), handle

    @property
    def sockets(self) -> tuple[socket.socket, socket.socket]:
        """Socket that the thread reads, and the one on which data ends its wait."""
        return self._sock, self._woken

    def use(self, loop: Loop | None) -> None:
        """Let a loop do the reading from now on; None reads as before. Safe while the thread runs."""
        before, self._loop = self._loop, loop
        if loop is not None:
            loop.stop(stopping=self._stopping)
        if before is not None and before is not loop:
            before.stop()
        self._wake_thread()

    def stop(self) -> None:
        """Ask the thread to handle the datagrams that have arrived, and to end.

        Safe in a signal handler; may be repeated.
        """
        self._stopping = True
        if self._loop is not None:
            self._loop.stop()
        self._wake_thread()

    def _wake_thread(self) -> None:
        with contextlib.suppress(OSError):  # the pipe is full, so the thread wakes anyway; or it has ended
            self._wake.send(b"\0")

    def look_again(self) -> int:
        """Ask the thread to look for datagrams, and return how often it has done so without a loop."""
        self._wake_thread()
        return self._rounds

    def join(self) -> None:
        """Wait until the thread ends. Raises `FailedThreadError` if an exception of ``handle`` ended it."""
        if threading.current_thread() is threading.main_thread():
            self._wait_for_end()
        self._thread.join()
        if self._failure is not None:
            raise FailedThreadError(self._thread.name, self._failure)

    def _wait_for_end(self) -> None:
        """Wait in the main thread until the thread ends.

        Python runs signal handlers only in the main thread, and a signal that arrives just before a wait does not end
        it. So each signal, too, sends a byte to the socket for which this waits.
        """
        told, tell = socket.socketpair()
        with told, tell:
            tell.setblocking(False)
            before = signal.set_wakeup_fd(tell.fileno(), warn_on_full_buffer=False)
            self._tell_end = lambda: tell.send(b"\0")
            try:
                while self._thread.is_alive() and not self._has_ended:
                    told.recv(1)
            finally:
                signal.set_wakeup_fd(before)

    def _run(self) -> None:
        self._read_until_stopped()
        self._has_ended = True
        with contextlib.suppress(OSError):  # nobody waits any more, or many signals have filled the socket
            self._tell_end()

    def _read_until_stopped(self) -> None:
        poll = select.poll()
        poll.register(self._sock, select.POLLIN)
        poll.register(self._woken, select.POLLIN)
        try:
            while not self._stopping:
                if (loop := self._loop) is not None:
                    loop.run()
                else:
                    # Level-triggered: it returns at once if data is left, so no datagram can be forgotten.
                    poll.poll()
                    self._handle_burst()
                self._rounds += 1
                with contextlib.suppress(BlockingIOError):
                    self._woken.recv(_SLOTS)
            self._drain()
        except BaseException as failure:  # noqa: BLE001  # `join` raises it
            self._failure = failure

    def _handle_burst(self) -> None:
        """Handle all datagrams that have arrived, and also those that arrive while this runs."""
        more = True
        while more and not self._stopping:
            read, handle = self._path
            datagrams = read()
            self._rounds += 1
            # Fewer than the slots: the socket was empty. Poll again instead of a read that returns nothing.
            more = len(datagrams) == _SLOTS
            _in_batches(datagrams, handle)

    def _drain(self) -> None:
        """Handle the datagrams that have arrived, but only for half a second: the sender may continue to send.

        Then count the datagrams that are left in `left`.
        """
        read, handle = self._path
        deadline = time.monotonic() + _DRAIN_S
        while time.monotonic() < deadline and (datagrams := read()):
            _in_batches(datagrams, handle)
        with contextlib.suppress(OSError):  # the socket is closed
            # A connected socket gets nothing from others any more, so that what is left has an end.
            self._sock.connect(self._sock.getsockname())
            while datagrams := read():
                self.left += len(datagrams)


def _in_batches(datagrams: list[T], handle: Callable[[list[T]], None]) -> None:
    for start in range(0, len(datagrams), BURST):
        handle(datagrams[start : start + BURST])
