"""Which address speaks for which peer, and how much of it is taken."""

from __future__ import annotations

import contextlib
import socket

import pytest

from roverlink.runtime import DatagramError, Reason
from roverlink.runtime.core.registry import Peer
from roverlink.runtime.net.sources import SourceGate, restricts_sources

_BOARD = Peer("board", "p", 1, sources=("10.0.0.7", "10.0.1.0/24"), source_rate=100)
_BASE = Peer("base", "q", 2, sources=("10.0.1.9", "192.168.0.0/16"))
_ANYONE = Peer("anyone", "r", 3)


def _refused(gate: SourceGate, address: str, now: float = 0.0) -> Reason:
    with pytest.raises(DatagramError, match=address.replace(".", r"\.")) as raised:
        gate.admit(socket.inet_aton(address), now)
    return raised.value.reason


@pytest.mark.parametrize(
    ("address", "peers"),
    [("10.0.0.7", {"board"}), ("10.0.1.255", {"board"}), ("192.168.3.4", {"base"}), ("10.0.1.9", {"board", "base"})],
)
def test_an_address_speaks_for_the_peers_that_name_it(address: str, peers: set[str]) -> None:
    """By itself, or by the network that it is in."""
    assert SourceGate([_BOARD, _BASE]).admit(socket.inet_aton(address), 0.0) == peers


@pytest.mark.parametrize("address", ["10.0.0.6", "10.0.2.0", "127.0.0.1", "255.255.255.255", "0.0.0.1"])
def test_a_stranger_is_refused_and_leaves_no_trace(address: str) -> None:
    """However many addresses a flood pretends to come from, nothing is kept of them."""
    gate = SourceGate([_BOARD, _BASE])
    assert _refused(gate, address) is Reason.UNKNOWN_SOURCE
    assert not gate._known


def test_a_peer_without_sources_is_anyone() -> None:
    """Any address speaks for it, and for nobody else."""
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


def test_the_flood_of_one_address_takes_nothing_from_another() -> None:
    """Each has its own allowance."""
    gate = SourceGate([_BOARD])
    while True:
        try:
            gate.admit(socket.inet_aton("10.0.1.1"), 0.0)
        except DatagramError:
            break
    assert gate.admit(socket.inet_aton("10.0.1.2"), 0.0) == {"board"}
    assert _refused(gate, "10.0.1.1") is Reason.OVER_RATE


def test_an_address_of_two_peers_has_the_larger_allowance() -> None:
    """Any number, where one of them says nothing."""
    gate = SourceGate([_BOARD, _BASE])
    for _ in range(1000):
        gate.admit(socket.inet_aton("10.0.1.9"), 0.0)


def test_a_peer_that_names_nobody_makes_nobody_generous() -> None:
    """A board keeps to its rate, though it might speak for that peer as well."""
    gate = SourceGate([_BOARD, _ANYONE])
    address = socket.inet_aton("10.0.0.7")
    for _ in range(32):
        assert gate.admit(address, 0.0) == {"board", "anyone"}
    assert _refused(gate, "10.0.0.7") is Reason.OVER_RATE


def test_what_is_known_of_addresses_is_bounded() -> None:
    """Also where every address may speak."""
    gate = SourceGate([_ANYONE])
    for number in range(10_000):
        gate.admit(number.to_bytes(4, "big"), 0.0)
    assert len(gate._known) == 4096


def test_a_table_that_names_nobody_restricts_nobody() -> None:
    """Then the receiving path does not even look at addresses."""
    assert not restricts_sources([_ANYONE])
    assert restricts_sources([_ANYONE, _BASE])
