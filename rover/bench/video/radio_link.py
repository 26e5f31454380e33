"""Radio link in user space: it has a limited rate and one queue for everything, and it loses packets."""

from __future__ import annotations

import contextlib
import random
import select
import socket
import threading
import time
from collections import deque
from collections.abc import Sequence

HOST = "127.0.0.1"
_QUEUE = 64_000
"""Bytes that wait at most; a radio with a short queue drops them instead."""
_HEADERS = 28  # bytes of IP and UDP


class _Flow:
    """Way of the datagrams for one port, and of the answers to their sender."""

    def __init__(self, port: int) -> None:
        self.near = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.near.bind((HOST, 0))
        self.far = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.far.bind((HOST, 0))
        self.to = HOST, port
        self.sender: tuple[str, int] | None = None


class RadioLink:
    """Link with several flows. A context manager: it hands datagrams on inside the block."""

    def __init__(self, ports: Sequence[int], *, rate: float = 0.0, loss: float = 0.0, seed: int = 1) -> None:
        """Hand on to ports of this computer, at most `rate` bits a second (0 for any), with a part `loss` missing."""
        self._flows = [_Flow(port) for port in ports]
        self._rate, self._loss = rate, loss
        self._rng = random.Random(seed)  # noqa: S311  # repeatable, not secret
        self._waiting: deque[tuple[float, bytes, socket.socket, tuple[str, int]]] = deque()
        self._bytes = 0
        self._free = 0.0  # time at which all before has left
        self._open = True
        self.dropped = 0
        self._thread = threading.Thread(target=self._run, daemon=True)

    @property
    def ports(self) -> list[int]:
        """Port to send to for each flow."""
        return [flow.near.getsockname()[1] for flow in self._flows]

    def __enter__(self) -> RadioLink:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._open = False
        self._thread.join()
        for flow in self._flows:
            flow.near.close()
            flow.far.close()

    def _run(self) -> None:
        by_socket = {flow.near: flow for flow in self._flows} | {flow.far: flow for flow in self._flows}
        while self._open:
            wait = 0.1 if not self._waiting else max(self._waiting[0][0] - time.monotonic(), 0)
            ready, _, _ = select.select(list(by_socket), [], [], wait)
            for sock in ready:
                self._take(sock, by_socket[sock])
            self._hand_on()

    def _take(self, sock: socket.socket, flow: _Flow) -> None:
        data, address = sock.recvfrom(65_536)
        if sock is flow.near:
            flow.sender = address
        if self._rng.random() < self._loss or self._bytes + len(data) > _QUEUE:
            self.dropped += 1
            return
        out, to = (flow.far, flow.to) if sock is flow.near else (flow.near, flow.sender)
        if to is not None:
            # A datagram arrives when its last bit does.
            busy = 8 * (len(data) + _HEADERS) / self._rate if self._rate else 0
            self._free = max(self._free, time.monotonic()) + busy
            self._waiting.append((self._free, data, out, to))
            self._bytes += len(data)

    def _hand_on(self) -> None:
        """Send the datagrams that have arrived at the other end."""
        while self._waiting and self._waiting[0][0] <= time.monotonic():
            _, data, out, to = self._waiting.popleft()
            self._bytes -= len(data)
            with contextlib.suppress(OSError):  # nobody listens there
                out.sendto(data, to)
