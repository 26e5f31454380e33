"""The simulated peers. They send the datagrams of a scenario, and count the datagrams that they receive."""

from __future__ import annotations

import contextlib
import socket
import threading
from collections import deque
from collections.abc import Callable, Mapping
from types import TracebackType

from roverlink.runtime import Registry
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.net import hosts, udp
from roverlink.runtime.text.host_names import LEARN
from roverlink.simulation.scenarios import Emission

_RECEIVE_BUFFER = 8 * 1024 * 1024
MOST_KEPT = 1000
"""Largest number of datagrams that wait until it is known whether they are requests."""


class Senders(contextlib.ExitStack):
    """Simulated peers that send datagrams to a bridge. A context manager.

    A simulated peer that restarts gets a new socket, so it sends from a new port.
    """

    def __init__(self, host: str, port: int, take: Callable[[udp.Batch], None] | None = None) -> None:
        """Send to the bridge at the IP address ``host`` and ``port``.

        ``take`` gets what the bridge sends to the peers' sockets, on other threads.
        """
        super().__init__()
        self._bridge, self._take = (host, port), take
        self._sockets: dict[tuple[str, int], socket.socket] = {}

    def send(self, emission: Emission) -> bool:
        """Send a datagram to the bridge; return false if the network of this host refuses it."""
        key = emission.peer, emission.life
        sock = self._sockets.get(key)
        if sock is None:
            family = hosts.family_of(self._bridge)
            sock = self._sockets[key] = self.enter_context(socket.socket(family, socket.SOCK_DGRAM))
            if self._take is not None:
                self.enter_context(udp.Receiver(sock, udp.LARGEST, self._take))
        try:
            sock.sendto(emission.datagram, self._bridge)
        except OSError:
            return False
        return True


def on_loopback(registry: Registry, ports: Mapping[EndName, int]) -> dict[str, str | int]:
    """Return the parameters of a bridge that sends each end's datagrams to a port of this computer.

    They set the host as well: the datagrams of a simulation must not reach the boards that the table names. The bridge
    still learns the address of an end whose host is ``learn``, from the datagrams of the simulation.
    """
    given: dict[str, str | int] = {}
    for name, end in registry.ends.items():
        host = LEARN if end.host == LEARN else "127.0.0.1"
        given |= {end.host_parameter: host, end.port_parameter: ports[name]}
    return given


class Arrivals:
    """Sockets on which the simulated peers receive datagrams of the bridge. A context manager.

    A thread reads each socket and counts the datagrams.
    """

    def __init__(self, registry: Registry) -> None:
        self._count = 0
        self.newest: deque[bytes] = deque(maxlen=MOST_KEPT)
        """Newest datagrams that have arrived, among which requests are; whoever takes one removes it."""
        self._lock = threading.Lock()
        self._stack = contextlib.ExitStack()
        self._sockets = {name: udp.bind("127.0.0.1", 0, _RECEIVE_BUFFER) for name in registry.ends}
        self.parameters = on_loopback(registry, {name: sock.getsockname()[1] for name, sock in self._sockets.items()})
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
            self._stack.enter_context(udp.Receiver(sock, udp.LARGEST, self._add))
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.__exit__(kind, error, trace)

    def _add(self, batch: udp.Batch) -> None:
        with self._lock:
            self._count += len(batch)
        self.newest.extend(batch)
