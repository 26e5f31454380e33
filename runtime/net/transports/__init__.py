"""Transports besides UDP: serial lines, TCP and CAN. Each carries whole datagrams between this computer and one end.

A `Transport` is the way to an end, and a `Connection` is this way while it works. Their users are `Carrier` and tests.
"""

from __future__ import annotations

from typing import Protocol

from roverlink.runtime.core.errors import SetupError
from roverlink.transport_addresses import transport_address


class NotTakenError(OSError):
    """An end has not taken a datagram. The line still works."""


class Connection(Protocol):
    """Working line to an end. One thread may receive while another one sends."""

    @property
    def refused(self) -> int:
        """Frames that were damaged, and therefore not received."""

    def receive(self, timeout: float) -> list[bytes]:
        """Return the datagrams that have arrived, oldest first; wait at most ``timeout`` seconds for the first one.

        Raises `OSError` if the line is gone.
        """

    def send(self, datagram: bytes) -> None:
        """Send a datagram, and return when the line has taken it: the next datagram would not wait long.

        Raises `NotTakenError` if the end does not take it, and another `OSError` if the line is gone.
        """

    def close(self) -> None:
        """Close the line. No other method runs meanwhile, or is called later."""


class Transport(Protocol):
    """Way to an end of the link."""

    name: str
    """Address as the user has written it."""
    largest: int
    """Largest datagram in bytes."""

    def connect(self) -> Connection:
        """Return a connection. Blocks for a few seconds at most.

        Raises `OSError`, whose text tells the user why there is none; a later call may succeed.
        """

    def close(self) -> None:
        """Free what waits for connections. `connect` is not called any more."""


def transport_at(host: str) -> Transport:
    """Return the transport of a host for which `names_transport` is true.

    Raises `SetupError` if the address is wrong, or if a package for this transport is not installed.
    """
    try:
        address = transport_address(host)
    except ValueError as error:
        raise SetupError(f"{host!r}: {error}") from error
    # A bridge without serial lines must not need pyserial.
    if address.kind == "serial":
        from roverlink.runtime.net.transports.serial import SerialTransport

        return SerialTransport(host, address)
    if address.kind == "tcp":
        from roverlink.runtime.net.transports.tcp import TcpTransport

        return TcpTransport(host, address)
    from roverlink.runtime.net.transports.can import CanTransport

    return CanTransport(host, address)
