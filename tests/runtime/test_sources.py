"""Which address speaks for which peer, and how much of it is taken."""

from __future__ import annotations

import contextlib
import socket

import pytest

from roverlink.runtime import DatagramError, Reason
from roverlink.runtime.core.registry import Peer
from roverlink.runtime.net.sources import SourceGate

_BOARD = Peer("board", "p", 1, sources=("10.0.0.7", "10.0.1.0/24"), source_rate=100)
_BASE = Peer("base", "q", 2, sources=("10.0.1.9", "192.168.0.0/16"))
_ANYONE = Peer("anyone", "r", 3)


def _refused(gate: SourceGate, address: str, now: float = 0.0) -> Reason:
    with pytest.raises(DatagramError, match=address.replace(".", r"\.")) as raised:
        gate.admit(socket.inet_aton(address), now)
    return raised.value.reason


def test_an_address_speaks_for_the_peers_that_name_it() -> None:
    """By itself, or by the network that it is in; others may say nothing, but for a peer that names nobody."""
    gate = SourceGate([_BOARD, _BASE])
    for address, peers in (
        *(("10.0.0.7", {"board"}), ("10.0.1.255", {"board"})),
        *(("192.168.3.4", {"base"}), ("10.0.1.9", {"board", "base"})),
    ):
        assert gate.admit(socket.inet_aton(address), 0.0) == peers
    for address in ("10.0.0.6", "10.0.2.0", "127.0.0.1", "255.255.255.255", "0.0.0.1"):
        assert _refused(gate, address) is Reason.UNKNOWN_SOURCE
    assert SourceGate([_BOARD, _ANYONE]).admit(socket.inet_aton("8.8.8.8"), 0.0) == {"anyone"}


def test_a_flood_is_taken_at_the_rate_of_its_peer() -> None:
    """A burst first, and from then on as many a second as the table says."""
    gate = SourceGate([_BOARD])
    address = socket.inet_aton("10.0.0.7")
    taken = 0
    for tick in range(20_000):
        with contextlib.suppress(DatagramError):
            gate.admit(address, tick / 2000)
            taken += 1
    assert 1000 <= taken <= 1040


def test_an_address_of_two_peers_has_the_larger_allowance() -> None:
    """Any number, where one that names it says nothing; a peer that names nobody makes nobody generous."""
    gate = SourceGate([_BOARD, _BASE, _ANYONE])
    for _ in range(1000):
        gate.admit(socket.inet_aton("10.0.1.9"), 0.0)
    for _ in range(32):
        assert gate.admit(socket.inet_aton("10.0.0.7"), 0.0) == {"board", "anyone"}
    assert _refused(gate, "10.0.0.7") is Reason.OVER_RATE


def test_what_is_known_of_addresses_is_bounded() -> None:
    """The newest 4096 addresses that may speak; of strangers, however many a flood pretends to be, nothing is kept."""
    gate = SourceGate([Peer("board", "p", 1, sources=("10.0.0.0/8",), source_rate=100)])
    own = 10 << 24
    for _ in range(32):
        gate.admit(own.to_bytes(4, "big"), 0.0)
    for number in range(10_000):
        with contextlib.suppress(DatagramError):
            gate.admit(number.to_bytes(4, "big"), 0.0)
    for number in range(own + 1, own + 4096):
        gate.admit(number.to_bytes(4, "big"), 0.0)
    assert _refused(gate, "10.0.0.0") is Reason.OVER_RATE
    for number in range(own + 1, own + 4098):
        gate.admit(number.to_bytes(4, "big"), 0.0)
    gate.admit(own.to_bytes(4, "big"), 0.0)  # as one that was never heard
