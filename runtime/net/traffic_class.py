"""Classes of traffic, with which routers and radios decide what they send first (DSCP, RFC 2474)."""

from __future__ import annotations

import contextlib
import socket
from enum import IntEnum


class TrafficClass(IntEnum):
    """Class of datagrams, by its code point. Wi-Fi gives both their own queues (RFC 8325)."""

    VIDEO = 34
    """AF41: it may wait (RFC 4594)."""
    COMMANDS = 46
    """EF: it is sent first (RFC 3246)."""


def mark(sock: socket.socket, traffic_class: TrafficClass) -> None:
    """Mark all datagrams of a socket. A system that does not allow this is no error."""
    ip = (socket.IPPROTO_IP, socket.IP_TOS)
    ipv6 = (socket.IPPROTO_IPV6, socket.IPV6_TCLASS) if hasattr(socket, "IPV6_TCLASS") else ip
    # A socket for IPv6 can also send to IPv4 addresses.
    for level, option in (ip, ipv6) if sock.family == socket.AF_INET6 else (ip,):
        with contextlib.suppress(OSError):
            sock.setsockopt(level, option, traffic_class << 2)  # the other two bits are those of ECN
