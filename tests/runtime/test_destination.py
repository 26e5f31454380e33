"""Sending to a peer: alone and in runs, and what the network says to it."""

from __future__ import annotations

import errno
import socket
from collections.abc import Iterator

import pytest
from needs import NOT_LINUX
from polling import PATIENCE_S

from roverlink.runtime.core.registry import EndName
from roverlink.runtime.net.destination import Destination, Target


@pytest.fixture
def peer() -> Iterator[socket.socket]:
    """The peer's socket."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024 * 1024)
        sock.bind(("127.0.0.1", 0))
        sock.settimeout(PATIENCE_S)
        yield sock


@pytest.fixture(params=["cutting", "one by one"])
def destination(request: pytest.FixtureRequest, peer: socket.socket) -> Iterator[Destination]:
    """The peer as a destination, where the system cuts messages into datagrams and where it does not."""
    destination = Destination(EndName("hardware"), Target(peer.getsockname()))
    if request.param == "one by one":
        destination._ways[0]._can_segment = False
    elif not destination._ways[0]._can_segment:
        pytest.skip(NOT_LINUX)  # which cuts messages into datagrams
    yield destination
    destination.close()


def _refusing() -> Destination:
    return Destination(EndName("hardware"), Target(("255.255.255.255", 6001)))  # a broadcast, which nobody allowed


def test_a_destination_gets_what_is_sent(destination: Destination, peer: socket.socket) -> None:
    """A destination sends to its peer, and is shown with its peer's name and address."""
    assert destination.send_all([b"hello"]) == []
    assert peer.recv(100) == b"hello"
    assert str(destination) == f"hardware at 127.0.0.1:{peer.getsockname()[1]}"


def test_a_destination_moves_with_its_peer(peer: socket.socket) -> None:
    """What is sent after the change goes to the new address, and what was sent before does not follow."""
    destination = Destination(EndName("hardware"), Target(("127.0.0.1", 9)))
    assert destination.send_all([b"lost"]) == []
    destination.direct_to(Target(peer.getsockname()))
    assert destination.send_all([b"hello"]) == []
    assert peer.recv(100) == b"hello"
    assert str(destination) == f"hardware at 127.0.0.1:{peer.getsockname()[1]}"
    destination.close()


@pytest.mark.parametrize(
    "sizes",
    [
        [],
        [5],
        [0],
        [51] * 8,
        [51] * 64,
        [51] * 200,
        [0, 0, 0],
        [7, 7, 0, 7, 7],
        [3, 1, 4, 1, 5, 9, 2, 6, 5, 5],
        [1472] * 9,
    ],
    ids=str,
)
def test_datagrams_stay_datagrams(destination: Destination, peer: socket.socket, sizes: list[int]) -> None:
    """Datagrams that are sent together come one by one, in order, each as long as it was."""
    datagrams = [bytes([number % 256]) * size for number, size in enumerate(sizes)]
    assert destination.send_all(datagrams) == []
    assert [peer.recv(2000) for _ in datagrams] == datagrams


def test_datagrams_too_long_to_go_together_go_alone(destination: Destination, peer: socket.socket) -> None:
    """A run that is longer than any message may be is sent all the same."""
    datagrams = [bytes([number]) * 30_000 for number in range(4)]
    assert destination.send_all(datagrams) == []
    assert [peer.recv(65_536) for _ in datagrams] == datagrams


def test_each_datagram_that_is_refused_is_told() -> None:
    """A network that refuses does so for each datagram, together or alone, from the first on."""
    destination = _refusing()
    try:
        (refusal,) = destination.send_all([b"hello"])
        assert isinstance(refusal, PermissionError)
        refusals = destination.send_all([b"hello"] * 3 + [b"hello, too"])
        assert [error.errno for error in refusals] == [errno.EACCES] * 4
    finally:
        destination.close()


def test_a_peer_that_comes_back_gets_every_datagram(destination: Destination, peer: socket.socket) -> None:
    """The news that nobody received an earlier datagram costs none of those that are sent once the peer is there."""
    address = peer.getsockname()
    peer.close()
    assert destination.send_all([b"into the void"]) == []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as again:
        again.bind(address)
        again.settimeout(PATIENCE_S)
        datagrams = [bytes([number]) * 9 for number in range(5)]
        assert destination.send_all(datagrams) == []
        assert [again.recv(100) for _ in datagrams] == datagrams


def test_a_system_that_can_segment_no_messages_sends_one_by_one(
    peer: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the kernel is older than the cutting, it would send many as one: it is never asked to."""

    def unknown(*_: object) -> int:
        raise OSError(errno.ENOPROTOOPT, "Protocol not available")

    monkeypatch.setattr(socket.socket, "getsockopt", unknown)
    destination = Destination(EndName("hardware"), Target(peer.getsockname()))
    try:
        assert destination.send_all([b"one", b"two"]) == []
        assert [peer.recv(100), peer.recv(100)] == [b"one", b"two"]
    finally:
        destination.close()
