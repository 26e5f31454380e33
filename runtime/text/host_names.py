"""Texts that name hosts: IP addresses, names that a resolver knows, the word ``learn``, or another transport."""

from __future__ import annotations

import re
from ipaddress import ip_address

from roverlink.transport_addresses import names_transport, transport_address

LEARN = "learn"
"""Host that stands for the address from which an end's last valid datagram came."""

_LABEL = re.compile(r"[A-Za-z0-9_]([A-Za-z0-9_-]{0,61}[A-Za-z0-9_])?")
_LONGEST_NAME = 253  # characters (RFC 1035, section 2.3.4, without the length bytes)


def hosts_in(text: str) -> tuple[str, ...]:
    """Return the hosts in a parameter's text, which separates several hosts by commas.

    Raises `ValueError` with the reason if one of them is neither an address nor a name, or if a host has neighbours
    that must be alone: ``learn``, and the address of another transport than UDP.
    """
    hosts = tuple(host.strip() for host in text.split(","))
    for host in hosts:
        if names_transport(host):
            transport_address(host)
        elif not is_literal(host) and not _is_name(host):
            raise ValueError(f"{host!r} is neither an IP address nor the name of a host")
    if len(hosts) > 1 and (alone := [host for host in hosts if host == LEARN or names_transport(host)]):
        raise ValueError(f"{alone[0]!r} cannot stand beside other hosts")
    return hosts


def is_literal(host: str) -> bool:
    """Return true if a host is an IP address, which needs no look-up."""
    try:
        ip_address(host)
    except ValueError:
        return False
    return True


def _is_name(host: str) -> bool:
    labels = host.removesuffix(".").split(".")
    # A last label of digits makes an address, as in 10.0.0.300 (RFC 1123, section 2.1), and no resolver may guess it.
    return len(host) <= _LONGEST_NAME and all(map(_LABEL.fullmatch, labels)) and not labels[-1].isdigit()
