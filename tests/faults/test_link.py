"""A bridge and a board with a link between them that is bad, cut, or somewhere else than before."""

from __future__ import annotations

import logging
from collections.abc import Iterator

import pytest
from network import BOARD, ROVER, Network, arrived, bound, inside, ip, why_not
from polling import wait_until
from relay import Relay

from generated.registry import REGISTRY
from roverlink.runtime import Bridge, Qos
from roverlink.runtime.bridge.account import Account, ThrottledWarnings
from roverlink.runtime.bridge.network_watch import NetworkWatch
from roverlink.runtime.middleware.joined_addresses import JoinedAddresses
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.ros_arguments import parameters

pytestmark = pytest.mark.skipif(bool(why_not()), reason=why_not())

_PORT, _BOARD_PORT = 5000, 6001
_DRIVE = REGISTRY.by_name["drive_motor"]


@pytest.fixture
def network() -> Iterator[Network]:
    """A rover and a board."""
    with Network() as network:
        yield network


class _Rig:
    """A bridge on the rover, over memory, and the board's socket."""

    def __init__(self, network: Network) -> None:
        self.network = network
        anywhere = {"listen_address": "0.0.0.0"}  # noqa: S104  # in a namespace
        settings = parameters.read(REGISTRY, {**anywhere, "dst_ip": BOARD, "dst_b_port": _BOARD_PORT})
        graph = Graph()
        others = (MemoryMiddleware(graph), lambda topic: f"/{topic}", logging.getLogger("x"))
        self.bridge = inside(network.rover, lambda: Bridge(REGISTRY, settings, *others))
        self.account = self.bridge.account
        self.board = inside(network.board, lambda: bound((BOARD, _BOARD_PORT)))
        self.node = MemoryMiddleware(graph)
        self.on_topic: list[bytes] = []
        self.node.subscribe("/imu_data", REGISTRY.by_name["imu_info"].message_type, Qos(), self.on_topic.extend)
        self.drive = self.node.publisher("/drive_motor", _DRIVE.message_type, Qos())

    def __enter__(self) -> _Rig:
        self.bridge.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self.bridge.__exit__(None, None, None)
        self.board.close()
        assert self.account.discrepancies() == []

    def command(self, number: float) -> None:
        """Publish a drive command."""
        self.drive.publish([_DRIVE.to_cdr(_DRIVE.payload_type(distance_to_go=number))])

    def said_to_board(self) -> list[float]:
        """The distances of the drive datagrams that have reached the board."""
        return [REGISTRY.envelope.FromString(one).drive_motor.distance_to_go for one in arrived(self.board)]

    def reach_board(self, number: float) -> None:
        """Publish a command until it goes through."""

        def arrives() -> bool:
            self.command(number)
            return number in self.said_to_board()

        wait_until(arrives, f"the command {number}")

    def hear_board(self, rover: str = ROVER) -> None:
        """Send from the board until the rover publishes."""

        def heard() -> list[bytes]:
            self.board.sendto(_imu(1), (rover, _PORT))
            return self.on_topic

        wait_until(heard, "a message of the board")


def _imu(number: int) -> bytes:
    return bytes(REGISTRY.envelope(imu_info={"accel_x": float(number)}).SerializeToString())


@pytest.mark.slow
def test_a_link_that_loses_repeats_and_reorders(network: Network) -> None:
    """Whatever comes through is published, once for each time it comes; nothing else is, and the sums agree."""
    count, burst = 1000, 50
    sock = inside(network.board, lambda: bound((BOARD, 0)))
    with _Rig(network) as rig, Relay(sock, (ROVER, _PORT), 7, loss=0.1, twice=0.05, delay_s=0.02) as relay:
        for number in range(count):
            rig.board.sendto(_imu(number), relay.address)
            if number % burst == burst - 1:  # so few at once that no buffer is full: the link alone loses some
                relay.wait_for(number + 1)
                wait_until(lambda: len(rig.on_topic) == relay.handed_on, "the burst")
        assert rig.account.published["imu_info"] == rig.account.received == relay.handed_on
        numbers = [REGISTRY.by_name["imu_info"].from_cdr(message).accel_x for message in rig.on_topic]
        assert 0.8 * count < len(set(numbers)) < len(numbers)
        assert set(numbers) <= set(range(count))
        assert numbers != sorted(numbers)


@pytest.mark.slow
def test_a_link_that_goes_away_and_returns(network: Network, caplog: pytest.LogCaptureFixture) -> None:
    """What could not be sent is counted; once the link is back both directions go on, and the stop is not forgotten."""
    with _Rig(network) as rig:
        rig.reach_board(1.0)
        ip("-n", network.rover, "link", "set", "cable", "down")
        for _ in range(20):
            rig.command(2.0)
        assert rig.account.failed["drive_motor"] >= 19
        wait_until(lambda: "the topic is silent" in caplog.text, "a stop of which nobody can be told")
        ip("-n", network.rover, "link", "set", "cable", "up")
        wait_until(lambda: 0.0 in rig.said_to_board(), "the stop")
        rig.reach_board(3.0)
        rig.hear_board()


def test_an_address_that_changes(network: Network) -> None:
    """The rover gets another address from its network: the bridge goes on, with the same sockets."""
    with _Rig(network) as rig:
        rig.reach_board(1.0)
        ip("-n", network.rover, "address", "del", f"{ROVER}/24", "dev", "cable")
        ip("-n", network.rover, "address", "add", "10.99.0.77/24", "dev", "cable")
        rig.reach_board(2.0)
        rig.hear_board("10.99.0.77")


def test_a_board_that_is_not_there_yet(network: Network) -> None:
    """No route at the start: the bridge starts all the same, and reaches the board once there is one."""
    ip("-n", network.rover, "address", "del", f"{ROVER}/24", "dev", "cable")
    with _Rig(network) as rig:
        rig.command(1.0)
        assert rig.account.failed["drive_motor"] == 1
        ip("-n", network.rover, "address", "add", f"{ROVER}/24", "dev", "cable")
        rig.reach_board(2.0)


@pytest.mark.parametrize("reach", ["SUBNET", "LOCALHOST"])
def test_a_network_that_changes_after_the_start_is_told(
    network: Network, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, reach: str
) -> None:
    """ROS 2 never uses an address that comes later, which concerns only who speaks with other computers."""
    monkeypatch.delenv("ROS_LOCALHOST_ONLY", raising=False)
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", reach)
    joined, account = inside(network.rover, JoinedAddresses), Account()
    watch = NetworkWatch(
        lambda: inside(network.rover, joined.changes), account, ThrottledWarnings(logging.getLogger("x"), lambda: 0.0)
    )
    for change, told in (
        ("link add late type veth peer name other", ""),
        ("address add 10.9.0.1/24 dev late", ""),
        ("link set late up", "(new: 10.9.0.1 of late)"),
        ("link del late", ""),
        ("link del cable", f"(lost: {ROVER} of cable)"),
    ):
        ip("-n", network.rover, *change.split())
        watch.run_due(watch.next_due)
        standing = account.standing.get("network", "")
        assert told in standing or reach == "LOCALHOST", change
        assert bool(standing) == (bool(told) and reach == "SUBNET"), change
    assert ("restart the program" in caplog.text) == (reach == "SUBNET")
