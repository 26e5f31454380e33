"""Addresses of hosts: look-up of names, and addresses as the kernel takes and gives them."""

from __future__ import annotations

import socket
import sys
from functools import lru_cache
from ipaddress import IPv6Address, ip_address
from typing import NamedTuple

SocketAddress = tuple[str, int] | tuple[str, int, int, int]
"""Address of a socket, as `socket.socket.sendto` takes it: IPv4 address and port, or the four values of IPv6."""

_SOCKADDR_IN = 16
"""Bytes of a sockaddr_in (ip(7)): family, port, address, padding.

A sockaddr_in6 (ipv6(7)) is longer: family, port, flow, address, scope.
"""


class Sender(NamedTuple):
    """Sender of a datagram."""

    ip: bytes
    """IP address without the port, four bytes (IPv4) or sixteen (IPv6)."""
    address: SocketAddress


def is_multicast(address: SocketAddress) -> bool:
    """Return true if an address is that of a multicast group."""
    return ip_address(address[0]).is_multicast


def look_up(host: str, port: int) -> list[SocketAddress]:
    """Return the addresses of a host with a port, the preferred one first. Can block for seconds if it is a name.

    Raises `OSError` or `UnicodeError` if the host has no address.
    """
    found = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)
    return list(dict.fromkeys(entry[4] for entry in found))  # type: ignore[misc]  # the addresses are those of IP


def reason_of(error: OSError | UnicodeError) -> str:
    """Return the text of an error of `look_up`, without its number."""
    return str(error.strerror or error) if isinstance(error, OSError) else str(error)


def family_of(address: SocketAddress) -> socket.AddressFamily:
    """Return the address family of an address: IPv4 or IPv6."""
    return socket.AF_INET if len(address) == 2 else socket.AF_INET6


def text_of(address: SocketAddress) -> str:
    """Return an address with its port as text: ``10.0.0.7:6000`` or ``[fd00::7]:6000``."""
    host, port = address[0], address[1]
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"


@lru_cache(4096)
def sender_at(address: SocketAddress) -> Sender:
    """Return the sender for the address that the kernel gives with a datagram.

    An IPv4 address that a socket for IPv4 and IPv6 shows as IPv6 (``::ffff:10.0.0.7``) becomes IPv4 again.
    """
    ip = ip_address(address[0].partition("%")[0])
    if isinstance(ip, IPv6Address) and ip.ipv4_mapped:
        return Sender(ip.ipv4_mapped.packed, (str(ip.ipv4_mapped), address[1]))
    return Sender(ip.packed, address)


@lru_cache(4096)
def sender_of(name: bytes) -> Sender:
    """Return the sender for the bytes of a sockaddr_in or a sockaddr_in6."""
    port = int.from_bytes(name[2:4], "big")
    if len(name) == _SOCKADDR_IN:
        return sender_at((socket.inet_ntoa(name[4:8]), port))
    flow, scope = int.from_bytes(name[4:8], "big"), int.from_bytes(name[24:28], sys.byteorder)
    return sender_at((socket.inet_ntop(socket.AF_INET6, name[8:24]), port, flow, scope))
