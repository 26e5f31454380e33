"""Addresses of ends that have another transport than UDP. The table and the runtime have the same ones.

The text of a host names the transport: ``serial:/dev/ttyACM0?baud=921600``, ``tcp:10.0.0.7:7000``,
``tcp:0.0.0.0:7000?listen``, ``can:can0?send=0x101&receive=0x102``. A host without such a word is one of UDP.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple
from urllib.parse import parse_qsl

from roverlink.datagram_size import LARGEST_DATAGRAM
from roverlink.suggestions import nearest


class Kind(NamedTuple):
    """Kind of transport: what its addresses may contain, and what it can carry."""

    place: str
    """Pattern of the text before the options."""
    example: str
    largest: int
    """Largest datagram in bytes."""
    options: Mapping[str, str] = {}
    """Pattern of the value of each option; the value of a flag is empty."""
    required: tuple[str, ...] = ()


_NUMBER = r"[1-9]\d{0,7}"
_CAN_ID = r"0[xX]([01][0-9A-Fa-f]{7}|[0-9A-Fa-f]{1,7})"  # not without 0x: CAN's tools write hexadecimal digits alone

KINDS: Mapping[str, Kind] = {
    "serial": Kind(r"[^,?\s]+", "serial:/dev/ttyACM0?baud=921600", 4096, {"baud": _NUMBER}),
    "tcp": Kind(r"(\[[\w:.%]+\]|[\w.-]+):\d{1,5}", "tcp:10.0.0.7:7000", LARGEST_DATAGRAM, {"listen": ""}),
    "can": Kind(
        r"[^,?\s]+",
        "can:can0?send=0x101&receive=0x102",
        4095,
        {"send": _CAN_ID, "receive": _CAN_ID, "fd": "[01]", "bus": r"\w+", "bitrate": _NUMBER},
        ("send", "receive"),
    ),
}
"""Kinds of transports besides UDP, by the word that begins their addresses."""


class TransportAddress(NamedTuple):
    """Address of an end that has another transport than UDP."""

    kind: str
    """Key of `KINDS`."""
    place: str
    """Path of a device, host and port, or name of an interface."""
    options: Mapping[str, str]


class CanId(NamedTuple):
    """Identifier of frames on a CAN bus."""

    number: int
    is_extended: bool
    """True if it has 29 bits, false if it has 11."""


def can_id(text: str) -> CanId:
    """Return the identifier that an option names: of 29 bits if it has eight digits, as in can-utils, or must have."""
    number = int(text, 16)
    return CanId(number, len(text) == len("0x00000101") or number > 0x7FF)


def names_transport(host: str) -> bool:
    """Return true if a host is the address of another transport than UDP, right or wrong."""
    kind, colon, _ = host.partition(":")
    return bool(colon) and kind in KINDS


def on_serial_line(hosts: Iterable[str]) -> bool:
    """Return true if one of some hosts is the address of a serial line."""
    return any(host.startswith("serial:") for host in hosts)


def largest_datagram(host: str) -> int:
    """Return the size in bytes of the largest datagram that the transport of a host carries."""
    return KINDS[host.partition(":")[0]].largest if names_transport(host) else LARGEST_DATAGRAM


def transport_address(host: str) -> TransportAddress:
    """Return the parts of an address for which `names_transport` is true. Raises `ValueError` with the reason."""
    word, _, rest = host.partition(":")
    kind, (place, mark, query) = KINDS[word], rest.partition("?")
    options = dict(parse_qsl(query, keep_blank_values=True))
    port = place.rpartition(":")[2] if word == "tcp" else "1"
    if not re.fullmatch(kind.place, place) or bool(mark) != bool(options) or not 0 < int(port) < 65_536:
        raise ValueError(f"write an address such as {kind.example}")
    for name, value in options.items():
        if name not in kind.options:
            raise ValueError(f"{word} has no option {name!r}; {nearest(name, kind.options)}")
        if not re.fullmatch(kind.options[name], value):
            raise ValueError(f"{value!r} is no value of the option {name!r}; write an address such as {kind.example}")
    if missing := [name for name in kind.required if name not in options]:
        raise ValueError(f"it lacks the option {missing[0]!r}; write an address such as {kind.example}")
    if word == "can" and can_id(options["send"]) == can_id(options["receive"]):
        raise ValueError(f"each direction needs an identifier of its own; write an address such as {kind.example}")
    return TransportAddress(word, place, options)
