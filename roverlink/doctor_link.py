"""Check of ``roverlink doctor``: whether the peers that answer have the same schema of their rows."""

from __future__ import annotations

import contextlib
import logging
import select
import socket
import time
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

from roverlink.runtime import Registry, RoverlinkError
from roverlink.runtime.bridge.account import Account, ThrottledWarnings
from roverlink.runtime.bridge.link_exchange import DIFFERS, UNKNOWN, EndReport, LinkExchange
from roverlink.runtime.core.handler import UNSTAMPED
from roverlink.runtime.core.translator import Translator
from roverlink.runtime.net import udp
from roverlink.runtime.net.carrier import Carrier
from roverlink.runtime.net.hosts import SocketAddress
from roverlink.runtime.net.transports import transport_at
from roverlink.runtime.ros_arguments.parameters import EndAddress, Parameters
from roverlink.runtime.text.host_names import LEARN

if TYPE_CHECKING:
    from roverlink.pinned_schemas import PinnedSchemas

_LISTEN_S = 2.5  # each end sends a link message about once a second
_POLL_S = 0.05


def verdicts(
    registry: Registry, settings: Parameters, pinned: PinnedSchemas | None = None
) -> Iterator[tuple[str, str, str, str]]:
    """Exchange link messages with the peers for a while, and yield the result for each end.

    ``pinned`` are the schemas of other projects: they tell if another schema of a row is compatible.

    A result has the verdict, the name of the check, its text, and advice. There is none for a table without the link
    message, or if the bridge's UDP port or the peers' address cannot be used, which other checks report.
    """
    if registry.link is not None:
        with contextlib.suppress(RoverlinkError):
            for report in _reports(registry, registry.link.hashes, settings):
                yield _verdict(report) if report.schema != DIFFERS else _verdict_of_differing(report, registry, pinned)


def _reports(registry: Registry, hashes: Mapping[int, int], settings: Parameters) -> list[EndReport]:
    with (
        udp.bind(settings.listen_address, settings.listen_port, settings.receive_buffer) as sock,
        contextlib.ExitStack() as stack,
    ):
        # From this socket, because a peer may answer to the address from which a datagram came.
        sends = {
            name: partial(_send, sock, [*_addresses(sock, address, stack)])
            for name, address in settings.addresses.items()
        }
        quiet = ThrottledWarnings(logging.Logger("doctor", logging.CRITICAL))
        exchange = LinkExchange(registry, hashes, sends, lambda *_: None, "warn", Account(), quiet)
        translator, read = Translator(registry), udp.reader(sock, settings.max_datagram + 1)
        deadline = time.monotonic() + _LISTEN_S
        while (now := time.monotonic()) < deadline:
            exchange.run_due(now)
            select.select([sock], [], [], _POLL_S)
            exchange.take(translator.receive_all(read(), UNSTAMPED))
        return exchange.reports()


def _addresses(sock: socket.socket, end: EndAddress, stack: contextlib.ExitStack) -> Iterator[SocketAddress]:
    """Yield the addresses of an end for a socket; none for a host that has to be learned, or that is not resolved.

    The line of an end is open as long as ``stack``.
    """
    if end.is_line:
        carrier = Carrier(transport_at(*end.hosts), sock)
        stack.callback(carrier.close)
        carrier.start()
        yield carrier.address
        return
    for host in end.hosts if end.hosts != (LEARN,) else ():
        with contextlib.suppress(OSError, UnicodeError):  # another check reports it
            # A socket for IPv6 reaches an IPv4 address in the form ::ffff:10.0.0.7.
            found = socket.getaddrinfo(host, end.port, sock.family, socket.SOCK_DGRAM, flags=socket.AI_V4MAPPED)
            yield found[0][4]  # type: ignore[misc]  # it is an address of IP


def _send(sock: socket.socket, addresses: Sequence[SocketAddress], datagrams: Sequence[bytes]) -> int:
    """Send datagrams to all addresses of an end, and return how many of them the network accepted."""
    accepted = 0
    for datagram in datagrams:
        with contextlib.suppress(OSError):  # the network refused it; the missing answer tells
            for address in addresses:
                sock.sendto(datagram, address)
            accepted += 1
    return accepted


def _verdict(report: EndReport) -> tuple[str, str, str, str]:
    check = f"schema of {report.end}"
    if report.schema == UNKNOWN:
        return "ok", check, f"not known: no link message came within {_LISTEN_S:g} s", ""
    untold = f"; it did not tell {', '.join(report.untold)}" if report.untold else ""
    return "ok", check, f"the same in all rows that it tells{untold}", ""


def _verdict_of_differing(
    report: EndReport, registry: Registry, pinned: PinnedSchemas | None
) -> tuple[str, str, str, str]:
    """Return the result for an end with another schema of some rows: an error, if it is not known to be compatible."""
    says, compatible = [], True
    for row in report.differing:
        payload = registry.by_name[row].payload_type.DESCRIPTOR.full_name
        known = pinned.compare(payload, report.told[row]) if pinned and row in report.told else None
        compatible = compatible and known is not None and known.compatible
        text = known.text if known else "that of no pinned project" if pinned else ""
        says.append(", ".join(filter(None, [f"another schema of {row}", text])))
    cure = "build the peer's program with the .proto files of the table"
    if pinned is None:
        cure += ", or give the commits that other projects use with --pins, to see if the schemas are compatible"
    return "warning" if compatible else "error", f"schema of {report.end}", "; ".join(says), cure
