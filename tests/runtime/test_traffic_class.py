"""Classes of traffic: commands are marked, so that radios and routers send them before video."""

from __future__ import annotations

import socket
from collections.abc import Iterator

import pytest
from needs import needs_linux
from polling import PATIENCE_S

from generated.pb2.components.basestation.control_mode_pb2 import MODE_AUTO, BasestationControlMode
from generated.registry import REGISTRY
from roverlink.runtime.client import BlockingPeer
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.net.destination import Destination, Target
from roverlink.runtime.net.traffic_class import TrafficClass

pytestmark = needs_linux


@pytest.fixture(params=["127.0.0.1", "::1"])
def receiver(request: pytest.FixtureRequest) -> Iterator[socket.socket]:
    """A socket that is told the marks of the datagrams."""
    is_ipv6 = ":" in request.param
    with socket.socket(socket.AF_INET6 if is_ipv6 else socket.AF_INET, socket.SOCK_DGRAM) as sock:
        if is_ipv6:
            sock.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_RECVTCLASS, 1)
        else:
            sock.setsockopt(socket.IPPROTO_IP, socket.IP_RECVTOS, 1)
        sock.bind((request.param, 0))
        sock.settimeout(PATIENCE_S)
        yield sock


def _class_of_next(receiver: socket.socket) -> int:
    _, ((_, _, mark),), _, _ = receiver.recvmsg(2048, socket.CMSG_SPACE(4))
    return mark[0] >> 2


def test_the_bridge_marks_its_datagrams(receiver: socket.socket) -> None:
    """As commands, alone and in runs."""
    destination = Destination(EndName("hardware"), Target(receiver.getsockname()))
    try:
        assert destination.send_all([b"one"]) == []
        assert destination.send_all([b"two"] * 8) == []
        assert {_class_of_next(receiver) for _ in range(9)} == {TrafficClass.COMMANDS}
    finally:
        destination.close()


def test_the_client_marks_its_datagrams(receiver: socket.socket) -> None:
    """As commands: what the operator does comes before the video."""
    address = receiver.getsockname()
    with BlockingPeer.open("basestation", registry=REGISTRY, host=address[0], port=address[1], local_port=0) as peer:
        peer.send(BasestationControlMode(mode=MODE_AUTO))
    assert _class_of_next(receiver) == TrafficClass.COMMANDS
