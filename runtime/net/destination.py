"""Sending of datagrams to an end of the link, one or many at once, to one or several addresses.

UDP segmentation offload (``UDP_SEGMENT``, udp(7), since Linux 4.18) cuts one large buffer into datagrams of equal size,
so the network stack runs once for all of them. On loopback a datagram sent in a group of eight takes 1.3 us of CPU, and
a datagram sent alone 4.7 us.
"""

from __future__ import annotations

import ctypes
import errno
import socket
import struct
import sys
import threading
from collections.abc import Callable, Sequence
from functools import cache
from itertools import groupby
from typing import NamedTuple

from roverlink.runtime.core.registry import EndName
from roverlink.runtime.net.hosts import SocketAddress, family_of, is_multicast, text_of
from roverlink.runtime.net.traffic_class import TrafficClass, mark

_UDP_SEGMENT = 103  # linux/udp.h

_ROUTE_LOST = frozenset({errno.ENETUNREACH, errno.EHOSTUNREACH, errno.EADDRNOTAVAIL, errno.EINVAL})
"""Errors of a connected socket after its address or network has disappeared."""
_LINK_LOST = _ROUTE_LOST | {errno.ENETDOWN, errno.ENODEV}

_NONE = -1  # no file descriptor
_NOWHERE = OSError(errno.EDESTADDRREQ, "its address is not known yet")


def is_told_by_event(error: OSError) -> bool:
    """Return true if an error of `Destination.send_all` belongs to a state of the link, which is reported on its own.

    The other errors concern single datagrams, such as one that is too long.
    """
    return error is _NOWHERE or error.errno in _LINK_LOST


class Target(NamedTuple):
    """Address to which datagrams are sent."""

    address: SocketAddress
    interface: int = 0
    """Index of the network interface, if the address is that of a multicast group; 0 for the kernel's choice."""
    ttl: int = 1
    """Largest number of networks, if the address is that of a multicast group; 1 does not cross a router."""


Report = Callable[[str, str], None]
"""Function that gets an address as text, and the reason why nothing can be sent there; empty if sending works again."""


class Destination:
    """Addresses of an end of the link, with the UDP sockets that send datagrams there.

    Safe to use from several threads.
    """

    def __init__(
        self,
        end: EndName,
        *targets: Target,
        report: Report = lambda *_: None,
        shared: socket.socket | None = None,
    ) -> None:
        """Send to ``targets``, the addresses of a peer or of its board.

        ``report`` is called when an address becomes unreachable, and when it is reachable again. ``shared`` is the
        socket to send from, if it cannot be any.
        """
        self.end = end
        self.connected_socket = ctypes.c_int32(_NONE)
        """File descriptor of the socket that is connected to the only address; -1 if only `send_all` can send.

        The native core reads it before each datagram.
        """
        self._report, self._shared = report, shared
        self._lock = threading.Lock()
        self._ways: list[_Way] = []
        self._used: tuple[_Way, ...] = ()
        self._serves_core = True
        self.seal = b""
        """Secret bytes in front of what is signed behind this socket, when a line is free; empty if nothing is."""
        self.direct_to(*targets)

    def direct_to(self, *targets: Target) -> None:
        """Send all further datagrams to ``targets``: each datagram to all of them. Without targets, send nothing."""
        with self._lock:
            self._ways += [
                _Way(self._report, self._note_route, self._shared) for _ in range(len(targets) - len(self._ways))
            ]
            for way, target in zip(self._ways, targets):
                way.direct_to(target)
            # One assignment, which is safe while other threads send. Ways that are not used any more stay open: another
            # thread may be sending through them.
            self._used = tuple(self._ways[: len(targets)])
            self._note_route()

    def keep_from_core(self) -> None:
        """Let only `send_all` send from now on, so that the native core asks Python to send each datagram."""
        self._serves_core = False
        self._note_route()

    def _note_route(self) -> None:
        routes = [way.connected_socket for way in self._used if self._serves_core and not self.seal]
        self.connected_socket.value = routes[0] if len(routes) == 1 else _NONE

    @property
    def addresses(self) -> tuple[SocketAddress, ...]:
        """Addresses to which datagrams are sent."""
        with self._lock:  # a change is told only when no datagram goes to the address before
            return tuple(way.target.address for way in self._used)

    @property
    def is_reachable(self) -> bool:
        """False if the network refused the last datagram to one of the addresses."""
        return not any(way.is_lost for way in self._used)

    def send_all(self, datagrams: Sequence[bytes]) -> list[OSError]:
        """Send datagrams in order; return one error for each datagram that the network refused.

        If there are several addresses, these are the errors of the address with the fewest.
        """
        used = self._used
        if len(used) == 1:
            return used[0].send_all(datagrams)
        return min((way.send_all(datagrams) for way in used), key=len, default=[_NOWHERE] * len(datagrams))

    def close(self) -> None:
        """Close the sockets."""
        for way in self._ways:
            way.close()

    def __str__(self) -> str:
        return f"{self.end} at {', '.join(map(text_of, self.addresses)) or 'no known address'}"


class _Way:
    """Sockets that send datagrams to one address."""

    def __init__(self, report: Report, note_route: Callable[[], None], shared: socket.socket | None) -> None:
        """``note_route`` is called when `connected_socket` has changed. ``shared`` is the only socket to send from."""
        self._report, self._note_route, self._shared = report, note_route, shared
        self._pairs: dict[int, tuple[socket.socket, socket.socket]] = {}
        self._lock = threading.Lock()
        self.target: Target = Target(("", 0))
        self._route: tuple[socket.socket, SocketAddress | None]
        self.is_lost = False

    @property
    def connected_socket(self) -> int:
        """File descriptor of the connected socket; -1 if it is not in use, or if the address was not reachable."""
        sock, address = self._route
        return _NONE if self.is_lost or address is not None else sock.fileno()

    def direct_to(self, target: Target) -> None:
        """Send all further datagrams to ``target``."""
        if target == self.target:
            return
        if self._shared is not None:
            self.target, self.is_lost = target, False
            mark(self._shared, TrafficClass.COMMANDS)
            self._route = self._shared, _for_family(target.address, self._shared.family)
            return
        address, family = target.address, family_of(target.address)
        if family not in self._pairs:
            # Both made now: switching between them is then one assignment, which is safe while other threads send.
            pair = socket.socket(family, socket.SOCK_DGRAM), socket.socket(family, socket.SOCK_DGRAM)
            for sock in pair:
                mark(sock, TrafficClass.COMMANDS)
            self._pairs[family] = pair
        connected, unconnected = self._pairs[family]
        if is_multicast(address):
            for sock in (connected, unconnected):
                _set_up_multicast(sock, target)
        self.target, self.is_lost = target, False
        try:
            connected.connect(address)  # the kernel then looks up the route once instead of for each datagram
            self._route = connected, None
        except OSError:
            self._route = unconnected, address

    def send_all(self, datagrams: Sequence[bytes]) -> list[OSError]:
        """Send datagrams in order; return one error for each datagram that the network refused."""
        refusals: list[OSError] = []
        # At low rates most datagrams come alone, and sorting them by size would cost as much as all else here.
        if len(datagrams) == 1:
            self._try_send(datagrams[0], refusals)
        else:
            # UDP_SEGMENT cuts into datagrams of one size, so only neighbours of equal size can go together, in order.
            for size, run in groupby(datagrams, len):
                same_size = list(run)
                if len(same_size) > 1 and self._send_as_one(same_size, size):
                    continue
                for datagram in same_size:
                    self._try_send(datagram, refusals)
        if refusals or self.is_lost:
            self._judge(len(datagrams), refusals)
        return refusals

    def close(self) -> None:
        """Close the sockets."""
        for pair in self._pairs.values():
            for sock in pair:
                sock.close()

    def _judge(self, count: int, refusals: list[OSError]) -> None:
        """Report that the address has become unreachable, or is reachable again, after ``count`` datagrams."""
        lost = next((error for error in refusals if error.errno in _LINK_LOST), None)
        with self._lock:  # several threads may send, and each event is reported once
            before = self.is_lost
            self.is_lost = lost is not None or (before and len(refusals) == count)
            changed = self.is_lost != before
        if changed:
            self._note_route()
            self._report(text_of(self.target.address), str(lost.strerror) if lost else "")

    def _try_send(self, datagram: bytes, refusals: list[OSError]) -> None:
        try:
            try:
                self._send(datagram)
            except ConnectionRefusedError:
                # An ICMP error of an earlier datagram: nobody listened. This datagram has not been sent yet.
                self._send(datagram)
        except OSError as error:
            if error.errno in _ROUTE_LOST and self._shared is None:
                # For the unconnected socket, the kernel looks up the route again for each datagram. So sending also
                # works after the network has changed, or if the network comes up late.
                self._route = self._pairs[family_of(self.target.address)][1], self.target.address
                self._note_route()
            refusals.append(error)

    def _send_as_one(self, same_size: list[bytes], size: int) -> bool:
        """Send datagrams of equal size with one system call.

        Return false if this failed; then none of them was sent.
        """
        # A segment size of 0 would mean "no segmentation", and empty datagrams would become one.
        if not can_segment() or size == 0:
            return False
        try:
            sock, address = self._route
            segments = (socket.IPPROTO_UDP, _UDP_SEGMENT, struct.pack("=H", size))
            sock.sendmsg(same_size, [segments], 0, address)
        except OSError:
            return False  # too long together, or refused: sending one by one shows the cause
        return True

    def _send(self, datagram: bytes) -> None:
        sock, address = self._route
        if address is None:
            sock.send(datagram)
        else:
            sock.sendto(datagram, address)


def _for_family(address: SocketAddress, family: int) -> SocketAddress:
    """Return an address as a socket of a family takes it: one of IPv6 needs an IPv4 address as ::ffff:10.0.0.7."""
    return (f"::ffff:{address[0]}", address[1], 0, 0) if (family, len(address)) == (socket.AF_INET6, 2) else address


def _set_up_multicast(sock: socket.socket, target: Target) -> None:
    """Set network interface and TTL of a socket that sends to a multicast group."""
    if sock.family == socket.AF_INET6:
        sock.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_MULTICAST_HOPS, target.ttl)
        sock.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_MULTICAST_IF, target.interface)
    else:
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, target.ttl)
        # struct ip_mreqn of ip(7): group, address of the interface, index of the interface
        interface = struct.pack("@4s4si", bytes(4), bytes(4), target.interface)
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, interface)


@cache
def can_segment() -> bool:
    """Return true if the kernel supports UDP_SEGMENT. An older kernel ignores it and would send one large datagram."""
    if sys.platform != "linux":
        return False
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        try:
            sock.getsockopt(socket.IPPROTO_UDP, _UDP_SEGMENT)
        except OSError:
            return False
    return True
