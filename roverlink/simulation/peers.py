"""Sockets of the simulated peers. They send the datagrams of a scenario, and count the datagrams that they receive."""

from __future__ import annotations

import contextlib
import socket
import threading
from collections.abc import Mapping
from types import TracebackType

from roverlink.runtime import Registry
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.net import udp
from roverlink.simulation.scenarios import Emission

_RECEIVE_BUFFER = 8 * 1024 * 1024
_LARGEST = 65_536


class Senders:
    """Sockets from which the simulated peers send datagrams to a bridge. A context manager.

    A simulated peer that restarts gets a new socket, so it sends from a new port.
    """

    def __init__(self, bridge: tuple[str, int]) -> None:
        self._bridge = bridge
        self._sockets: dict[tuple[str, int], socket.socket] = {}

    def send(self, emission: Emission) -> bool:
        """Send a datagram to the bridge; return false if the network of this host refuses it."""
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


def on_loopback(registry: Registry, sockets: Mapping[EndName, socket.socket]) -> dict[str, str | int]:
    """Return the parameters of a bridge that sends each end's datagrams to a socket on this computer.

    They set the host as well: the datagrams of a simulation must not reach the boards that the table names.
    """
    given: dict[str, str | int] = {}
    for name, end in registry.ends.items():
        given |= {end.host_parameter: "127.0.0.1", end.port_parameter: int(sockets[name].getsockname()[1])}
    return given


class Arrivals:
    """Sockets on which the simulated peers receive datagrams of the bridge. A context manager.

    A thread reads each socket and counts the datagrams.
    """

    def __init__(self, registry: Registry) -> None:
        self._count = 0
        self._lock = threading.Lock()
        self._stack = contextlib.ExitStack()
        self._sockets = {name: udp.bind("127.0.0.1", 0, _RECEIVE_BUFFER) for name in registry.ends}
        self.parameters = on_loopback(registry, self._sockets)
        """Parameters that direct a bridge to these sockets."""

    @property
    def count(self) -> int:
        """Number of datagrams that the peers together have received."""
        return self._count

    @property
    def lost(self) -> int:
        """Number of datagrams that the kernel dropped at these sockets, because this process read them too slowly."""
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
