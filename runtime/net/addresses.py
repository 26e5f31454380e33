"""Addresses that the bridge tells its user."""

from __future__ import annotations

import socket

_EVERYWHERE = ("", "0.0.0.0")  # noqa: S104  # only on request of the user


def openable_host(address: str) -> str:
    """Return a host that a browser can open, for the IPv4 address on which a server listens.

    A server that listens on all addresses (``0.0.0.0``) is reached under the address that this computer uses towards
    other computers, or under its name if it has no route to them.
    """
    if address not in _EVERYWHERE:
        return address
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        try:
            # Connecting a UDP socket sends nothing; it only selects a route. The address is reserved (RFC 5737).
            sock.connect(("192.0.2.1", 9))
        except OSError:
            return socket.gethostname()
        return str(sock.getsockname()[0])
