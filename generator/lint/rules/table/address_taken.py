"""Two peers, or two boards, have the same address and UDP port.

The address tells the bridge to whom a datagram goes. If two ends of the link share it, one program gets the datagrams
of both, and the other gets none. Peers without a `host` all have the address in the parameter `dst_ip`.

Bad::

    peers:
      hardware: {host: 192.168.0.21, port: 8}
      basestation: {host: 192.168.0.21, port: 8}

Good::

    peers:
      hardware: {host: 192.168.0.21, port: 8}
      basestation: {host: 192.168.0.22, port: 8}
"""

from __future__ import annotations

from collections.abc import Iterator
from ipaddress import ip_address

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context
from roverlink.generator.table import LEARN, EndSettings

RULE = Rule("TAB114", "address-taken", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each peer or board whose address and port an earlier one has."""
    seen: dict[tuple[str, int], tuple[str, EndSettings]] = {}
    for peer in context.table.peers:
        for settings, end in peer.ends:
            name = f"{end.name} of {peer.name}" if peer.boards else peer.name
            for host in settings.hosts or ("",):
                if host == LEARN:
                    continue
                first, place = seen.setdefault((_canonical(host), end.port), (name, settings))
                if place is not settings:
                    where = f"port {end.port} of {host or 'the host in the parameter dst_ip'}"
                    message = f"{name!r} and {first!r} both have {where}"
                    key = "port" if "port" in settings.spans else "host"
                    also = [(place.at(key), f"the address of {first!r}")]
                    yield RULE.at(settings.at(key), message, "give each of them its own `host` or `port`", also)


def _canonical(host: str) -> str:
    """Return one spelling for each host: names have no capitals, and IPv6 has many spellings of one address."""
    try:
        return str(ip_address(host))
    except ValueError:
        return host.lower().removesuffix(".")
