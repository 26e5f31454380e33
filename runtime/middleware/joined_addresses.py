"""Network addresses with which a node has joined ROS 2.

Cyclone DDS and Fast DDS read the network interfaces once, when the first participant of a process joins a domain.
They never use an address that comes later, and join no multicast group there.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import socket
import struct
import sys
from typing import NamedTuple

# ioctls of netdevice(7), with a `struct ifreq`: 16 bytes for the name, then flags, or an address behind its family
_SIOCGIFFLAGS, _SIOCGIFADDR = 0x8913, 0x8915
_UP, _LOOPBACK = 0x1, 0x8


class _Address(NamedTuple):
    number: int
    """Index of the interface; an interface that was removed and comes back has another one."""
    interface: str
    ip: str


class JoinedAddresses:
    """IPv4 addresses of this computer at the moment when a node joins ROS 2."""

    def __init__(self) -> None:
        self._local = is_local()
        self._joined = _addresses()

    def changes(self) -> str:
        """Return a text about new and lost addresses; empty if there are none, or if ROS 2 stays on this computer."""
        if self._local:
            return ""
        now = _addresses()
        changes = {"new": now - self._joined, "lost": self._joined - now}
        told = [
            f"{what}: {', '.join(f'{one.ip} of {one.interface}' for one in sorted(those))}"
            for what, those in changes.items()
            if those
        ]
        if not told:
            return ""
        return (
            f"the network addresses of this computer have changed since the start ({'; '.join(told)}), but ROS 2 uses "
            "only those of the start; restart the program to reach the nodes of other computers"
        )


def is_local() -> bool:
    """Return true if the environment restricts ROS 2 to this computer.

    ``ROS_LOCALHOST_ONLY`` is the variable up to Humble, the range is from Iron on.
    """
    reach = os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE")
    return os.environ.get("ROS_LOCALHOST_ONLY") == "1" or reach == "LOCALHOST"


def _addresses() -> frozenset[_Address]:
    """Return the IPv4 addresses of all network interfaces that are up, without loopback; none except on Linux."""
    found: set[_Address] = set()
    if sys.platform != "linux":
        return frozenset()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        for index, name in socket.if_nameindex():
            request = struct.pack("16s24x", name.encode())
            with contextlib.suppress(OSError):  # it has no IPv4 address, or has just vanished
                (flags,) = struct.unpack_from("=H", fcntl.ioctl(sock, _SIOCGIFFLAGS, request), 16)
                if flags & _UP and not flags & _LOOPBACK:
                    ip = socket.inet_ntoa(fcntl.ioctl(sock, _SIOCGIFADDR, request)[20:24])
                    found.add(_Address(index, name, ip))
    return frozenset(found)
