"""The UDP side: a bound socket that a thread of its own empties, and sockets to send from.

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
from collections import deque
from collections.abc import Callable

from runtime import mmsg
from runtime.errors import SetupError

_SO_RCVBUFFORCE = 33
_SO_MEMINFO = 55
_MEMINFO_DROPS = 8  # SK_MEMINFO_DROPS in linux/sock_diag.h
_COALESCING_PAUSE_S = 0.0005

Batch = list[bytes]


def bind(address: str, port: int, receive_buffer: int) -> socket.socket:
    """A UDP socket that listens, with a receive buffer as near to ``receive_buffer`` bytes as the system lets it have.

    Raises `SetupError` that says which port cannot be had and why.
    """
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        _size_receive_buffer(sock, receive_buffer)
        sock.bind((address, port))
    except OSError as error:
        sock.close()
        raise SetupError(_bind_failure(address, port, error)) from error
    return sock


def _bind_failure(address: str, port: int, error: OSError) -> str:
    if error.errno == errno.EADDRINUSE:
        return f"UDP port {port} on {address} is in use by another program; stop it, or choose another listen_port"
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


def kernel_drops(sock: socket.socket) -> int:
    """Datagrams that the kernel dropped because the receive buffer was full; 0 where the system does not say."""
    if sys.platform != "linux":
        return 0
    try:
        words = sock.getsockopt(socket.SOL_SOCKET, _SO_MEMINFO, 4 * (_MEMINFO_DROPS + 1))
    except OSError:
        return 0
    drops: int = struct.unpack(f"{len(words) // 4}I", words)[_MEMINFO_DROPS]
    return drops


def resolve(host: str, port: int) -> tuple[str, int]:
    """The IPv4 address of a host. Raises `SetupError` where the name does not resolve."""
    try:
        found = socket.getaddrinfo(host, port, socket.AF_INET, socket.SOCK_DGRAM)
    except (OSError, UnicodeError) as error:
        raise SetupError(f"the destination {host!r} does not resolve: {error}") from error
    address: tuple[str, int] = found[0][4]  # type: ignore[assignment]  # AF_INET was asked for
    return address


class Inbox:
    """Batches of datagrams on their way from the receiving thread to the one that handles them; bounded."""

    def __init__(self, limit: int) -> None:
        self._batches: deque[Batch] = deque()
        self._limit = limit
        self._room = limit
        self._ready = threading.Semaphore(0)
        self._closed = False
        self.overflow = 0
        """Datagrams that found the inbox full."""

    def put(self, batch: Batch) -> None:
        """Add a batch, or count it as overflow where ``limit`` datagrams wait already. Never waits."""
        if len(batch) > self._room:
            self.overflow += len(batch)
            return
        self._room -= len(batch)
        self._batches.append(batch)
        self._ready.release()

    def close(self) -> None:
        """Nothing more will be put; `get` returns None once all is taken."""
        self._closed = True
        self._ready.release()

    @property
    def waiting(self) -> bool:
        """Whether a batch has not been taken yet."""
        return bool(self._batches)

    def get(self) -> Batch | None:
        """The oldest batch, waiting for one; None when the inbox is closed and empty."""
        self._ready.acquire()
        if not self._batches:
            self._ready.release()
            return None
        batch = self._batches.popleft()
        self._room += len(batch)
        return batch


class Receiver:
    """The thread that empties a UDP socket into an inbox and waits for nothing else.

    A context manager: leaving it stops the thread, after everything that had arrived is in the inbox.
    """

    def __init__(self, sock: socket.socket, size: int, inbox: Inbox) -> None:
        self._sock = sock
        self._inbox = inbox
        self._read = _reader(sock, size)
        self._wake, self._woken = socket.socketpair()
        self._thread = threading.Thread(target=self._run, name="udp-receive", daemon=True)

    def __enter__(self) -> Receiver:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()
        self._thread.join()
        self._wake.close()
        self._woken.close()

    def stop(self) -> None:
        """Ask the thread to drain the socket and end. May be called from a signal handler, and more than once."""
        self._wake.send(b"\0")

    def _run(self) -> None:
        poll = select.poll()
        poll.register(self._sock, select.POLLIN)
        poll.register(self._woken, select.POLLIN)
        try:
            while not any(descriptor == self._woken.fileno() for descriptor, _ in poll.poll()):
                self._drain()
                if self._inbox.waiting:
                    # The handling thread is behind. Woken for every datagram, this thread would only take the
                    # interpreter from it; meanwhile the kernel's buffer gathers a larger batch.
                    time.sleep(_COALESCING_PAUSE_S)
            self._drain()
        finally:
            self._inbox.close()

    def _drain(self) -> None:
        while batch := self._read():
            self._inbox.put(batch)


def _reader(sock: socket.socket, size: int) -> Callable[[], Batch]:
    return mmsg.BatchReader(sock, size).read if mmsg.AVAILABLE else OneByOneReader(sock, size).read


class OneByOneReader:
    """Reads what a UDP socket holds with the calls that every system has."""

    def __init__(self, sock: socket.socket, size: int, limit: int = 128) -> None:
        self._sock, self._size, self._limit = sock, size, limit
        sock.setblocking(False)

    def read(self) -> Batch:
        """The datagrams that have arrived, oldest first, each cut to ``size`` bytes; empty where there are none."""
        batch: Batch = []
        while len(batch) < self._limit:
            try:
                batch.append(self._sock.recv(self._size))
            except (BlockingIOError, InterruptedError):
                break
        return batch
