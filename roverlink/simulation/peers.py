"""Sockets of simulated boards and basestation: they send a scenario's datagrams and count those received."""

from __future__ import annotations

import contextlib
import socket
import threading
from types import TracebackType

from roverlink.runtime import Registry
from roverlink.runtime.net import udp
from roverlink.simulation.scenarios import Emission

_RECEIVE_BUFFER = 8 * 1024 * 1024
_LARGEST = 65_536


class Senders:
    """Sending sockets of the peers, a new one after each restart of a peer. A context manager."""

    def __init__(self, bridge: tuple[str, int]) -> None:
        self._bridge = bridge
        self._sockets: dict[tuple[str, int], socket.socket] = {}

    def send(self, emission: Emission) -> bool:
        """Send a datagram; return false if this host's network refuses it."""
        key = emission.peer, emission.life
        sock = self._sockets.get(key)
        if sock is None:
            # Not connected: a connected socket would report that the bridge is not there yet (ICMP) as an error of the
            # next send.
            sock = self._sockets[key] = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            sock.sendto(emission.datagram, self._bridge)
        except OSError:
            return False
        return True

    def __enter__(self) -> Senders:
        return self

    def __exit__(self, *_: object) -> None:
        for sock in self._sockets.values():
            sock.close()


class Arrivals:
    """Receiving sockets of the peers, each read by a thread. A context manager."""

    def __init__(self, registry: Registry) -> None:
        self._count = 0
        self._lock = threading.Lock()
        self._stack = contextlib.ExitStack()
        self._sockets = {peer.name: udp.bind("127.0.0.1", 0, _RECEIVE_BUFFER) for peer in registry.peers}
        self.ports = {peer.port_parameter: int(self._sockets[peer.name].getsockname()[1]) for peer in registry.peers}

    @property
    def count(self) -> int:
        """Datagrams received by all peers."""
        return self._count

    @property
    def lost(self) -> int:
        """Datagrams that the kernel dropped because this process was too slow."""
        return sum(udp.kernel_drops(sock) for sock in self._sockets.values())

    def __enter__(self) -> Arrivals:
        for sock in self._sockets.values():
            self._stack.enter_context(sock)
        for sock in self._sockets.values():
            self._stack.enter_context(udp.Receiver(sock, _LARGEST, self._add))
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.__exit__(kind, error, trace)

    def _add(self, batch: udp.Batch) -> None:
        with self._lock:
            self._count += len(batch)
