"""A bad link in user space, for kernels without netem: it loses, repeats, delays and so reorders datagrams."""

from __future__ import annotations

import heapq
import random
import select
import socket
import threading
import time

from polling import wait_until


class Relay:
    """Hands datagrams on to an address, badly. A context manager; leaving it hands on what is still delayed."""

    def __init__(
        self, sock: socket.socket, to: tuple[str, int], seed: int, loss: float, twice: float, delay_s: float
    ) -> None:
        self._socket, self._to = sock, to
        self._socket.setblocking(True)  # where a buffer is full, the kernel makes the relay wait
        self._rng = random.Random(seed)  # noqa: S311  # repeatable, not secret
        self._loss, self._twice, self._delay_s = loss, twice, delay_s
        self._late: list[tuple[float, int, bytes]] = []
        self._open = True
        self._thread = threading.Thread(target=self._run, daemon=True)
        self.taken = self.handed_on = 0
        self.address: tuple[str, int] = sock.getsockname()
        """Where to send to."""

    def __enter__(self) -> Relay:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._open = False
        self._thread.join()
        self._socket.close()

    def wait_for(self, taken: int) -> None:
        """Wait until this many datagrams have come, and all of them that are not lost have been handed on."""
        wait_until(lambda: self.has_taken(taken), f"{taken} datagrams at the relay")

    def has_taken(self, taken: int) -> bool:
        """Return true if this many datagrams have come, and all of them that are not lost have been handed on."""
        return self.taken == taken and not self._late

    def _run(self) -> None:
        poll = select.poll()
        poll.register(self._socket, select.POLLIN)
        while self._open or self._late:
            if poll.poll(1):
                self._take(self._socket.recv(65_536))
            while self._late and self._late[0][0] <= time.monotonic():
                self._socket.sendto(self._late[0][2], self._to)
                self.handed_on += 1
                heapq.heappop(self._late)  # last: `wait_for` looks at it from another thread

    def _take(self, datagram: bytes) -> None:
        if self._rng.random() >= self._loss:
            for _ in range(1 + (self._rng.random() < self._twice)):
                at = time.monotonic() + self._rng.uniform(0, self._delay_s)
                heapq.heappush(self._late, (at, self._rng.getrandbits(32), datagram))
        self.taken += 1
