"""Sending to a peer: alone and in runs, what the network says to it, and the class of its traffic."""

from __future__ import annotations

import errno
import socket
import sys
from collections.abc import Iterator

import pytest
from bridge_rig import listener, port_of
from needs import NOT_LINUX, needs_linux
from polling import PATIENCE_S

from generated.pb2.components.basestation.control_mode_pb2 import BasestationControlMode
from generated.registry import REGISTRY
from roverlink.runtime.client import BlockingPeer
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.net.destination import Destination, Target
from roverlink.runtime.net.traffic_class import TrafficClass

_HARDWARE = EndName("hardware")


@pytest.fixture
def peer() -> Iterator[socket.socket]:
    """The peer's socket."""
    with listener() as sock:
        yield sock


@pytest.fixture(params=["cutting", "one by one"])
def destination(
    request: pytest.FixtureRequest, peer: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Destination]:
    """The peer as a destination, where the system cuts messages into datagrams, and where it is too old for that."""
    if request.param == "cutting" and sys.platform != "linux":
        pytest.skip(NOT_LINUX)
    if request.param == "one by one":

        def unknown(*_: object) -> int:
            raise OSError(errno.ENOPROTOOPT, "Protocol not available")

        monkeypatch.setattr(socket.socket, "getsockopt", unknown)
    destination = Destination(_HARDWARE, Target(peer.getsockname()))
    yield destination
    destination.close()


@pytest.mark.parametrize(
    "sizes",
    [
        [],
        [0],
        [51] * 8,
        [51] * 200,
        [0, 0, 0],
        [7, 7, 0, 7, 7],
        [3, 1, 4, 1, 5, 9, 2, 6, 5, 5],
        [1472] * 9,
        [30_000] * 4,  # longer together than any message may be
    ],
    ids=str,
)
def test_datagrams_stay_datagrams(destination: Destination, peer: socket.socket, sizes: list[int]) -> None:
    """Datagrams that are sent together come one by one, in order, each as long as it was."""
    datagrams = [bytes([number % 256]) * size for number, size in enumerate(sizes)]
    assert destination.send_all(datagrams) == []
    assert [peer.recv(65_536) for _ in datagrams] == datagrams


def test_each_datagram_that_is_refused_is_told(destination: Destination) -> None:
    """A network that refuses does so for each datagram, together or alone, from the first on."""
    destination.direct_to(Target(("255.255.255.255", 6001)))  # a broadcast, which nobody allowed
    for datagrams in ([b"hello"], [b"hello"] * 3 + [b"hello, too"]):
        assert [error.errno for error in destination.send_all(datagrams)] == [errno.EACCES] * len(datagrams)


def test_a_peer_that_comes_back_gets_every_datagram(destination: Destination, peer: socket.socket) -> None:
    """The news that nobody received an earlier datagram costs none of those that are sent once the peer is there."""
    address = peer.getsockname()
    peer.close()
    assert destination.send_all([b"into the void"]) == []
    with listener(*address) as again:
        datagrams = [bytes([number]) * 9 for number in range(5)]
        assert destination.send_all(datagrams) == []
        assert [again.recv(100) for _ in datagrams] == datagrams


@needs_linux
@pytest.mark.parametrize("host", ["127.0.0.1", "::1"])
def test_datagrams_are_marked_as_commands(host: str) -> None:
    """Alone, in runs, and by the client: radios and routers send what the operator does before video."""
    family, level, option = {
        "127.0.0.1": (socket.AF_INET, socket.IPPROTO_IP, socket.IP_RECVTOS),
        "::1": (socket.AF_INET6, socket.IPPROTO_IPV6, socket.IPV6_RECVTCLASS),
    }[host]
    with socket.socket(family, socket.SOCK_DGRAM) as sock:
        sock.setsockopt(level, option, 1)
        sock.bind((host, 0))
        sock.settimeout(PATIENCE_S)
        destination = Destination(_HARDWARE, Target(sock.getsockname()))
        assert destination.send_all([b"one"]) == destination.send_all([b"two"] * 8) == []
        destination.close()
        with BlockingPeer.open("basestation", registry=REGISTRY, host=host, port=port_of(sock), local_port=0) as peer:
            peer.send(BasestationControlMode())
        marks = [sock.recvmsg(2048, socket.CMSG_SPACE(4))[1][0][2][0] for _ in range(10)]
        assert {mark >> 2 for mark in marks} == {TrafficClass.COMMANDS}
