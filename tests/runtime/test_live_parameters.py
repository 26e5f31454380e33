"""Parameters of a running bridge: each change is checked and applied as a whole."""

from __future__ import annotations

import logging
import socket
from collections.abc import Iterator, Sequence
from typing import Any

import pytest
from polling import PATIENCE_S, wait_until
from tables import changed, of_peers, unguarded

from generated.registry import REGISTRY
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import Bridge, Registry, SetupError
from roverlink.runtime.bridge.bridge import Handle, Observer, Send
from roverlink.runtime.middleware.memory import MemoryMiddleware
from roverlink.runtime.ros_arguments import parameters
from roverlink.runtime.ros_arguments.live_parameters import LiveParameters

_QUIET = unguarded(REGISTRY)
_LOGGER = logging.getLogger("test_live_parameters")
_IMU = REGISTRY.envelope(imu_info=payload_at(REGISTRY.by_name["imu_info"].payload_type, 1.0)).SerializeToString()


class _Running:
    """A bridge, a board that sends to it, and its parameters."""

    def __init__(self, registry: Registry = _QUIET, observers: Sequence[Observer] = (), **given: Any) -> None:
        settings = parameters.read(registry, {"listen_port": 0, "listen_address": "127.0.0.1", **given})
        self.live = LiveParameters(registry, settings, _LOGGER)
        self.bridge = Bridge(registry, settings, MemoryMiddleware(), lambda topic: f"/{topic}", _LOGGER, observers)
        self.live.on_change(self.bridge.change)
        self._board = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def __enter__(self) -> _Running:
        self.bridge.__enter__()
        self._board.connect(("127.0.0.1", self.bridge.port))
        return self

    def __exit__(self, *_: object) -> None:
        self.bridge.__exit__()
        self._board.close()

    def bridge_one(self) -> None:
        """Send a datagram, and wait until the bridge has handled it."""
        before = self.bridge.account.received
        self._board.send(_IMU)
        wait_until(lambda: self.bridge.account.received > before, "the datagram")
        wait_until(lambda: sum(self._ends()) > before, "the end of the datagram")

    def _ends(self) -> tuple[int, int]:
        account = self.bridge.account
        return account.published.total(), account.dropped.total()


@pytest.fixture
def listener() -> Iterator[socket.socket]:
    """The socket of a peer."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        sock.settimeout(PATIENCE_S)
        yield sock


def test_a_peers_address_changes_while_the_bridge_runs(listener: socket.socket) -> None:
    """Datagrams go to the new port of a peer from the change on."""
    with _Running(forward_policy="all") as running:
        running.bridge_one()
        running.live.change({"dst_a_port": listener.getsockname()[1]})
        running.bridge_one()
        assert listener.recv(2048) == _IMU
    assert running.live.values["dst_a_port"] == listener.getsockname()[1]


def test_the_policy_of_forwards_changes_while_the_bridge_runs(listener: socket.socket) -> None:
    """Only with the policy `all` a peer gets the datagrams of rows that have no `forward`."""
    registry = _without_forwards()
    with _Running(registry, dst_a_port=listener.getsockname()[1]) as running:
        running.bridge_one()
        assert running.bridge.account.forwarded.total() == 0
        running.live.change({"forward_policy": "all"})
        running.bridge_one()
        assert listener.recv(2048) == _IMU
        running.live.change({"forward_policy": "mapping"})
        forwarded = running.bridge.account.forwarded.total()
        running.bridge_one()
    assert running.bridge.account.forwarded.total() == forwarded


class _Wrappings:
    """Observer that counts how often it is asked to wrap the handler of datagrams."""

    count = 0

    def receiving(self, handle: Handle) -> Handle:
        self.count += 1
        return handle

    def sending(self, peer: str, send: Send) -> Send:  # part of the Observer interface
        return send


def test_a_change_wraps_no_observer_again(listener: socket.socket) -> None:
    """An observer is asked at the start; changes of parameters do not ask it once more."""
    observer = _Wrappings()
    with _Running(observers=[observer], source_policy="any") as running:
        asked = observer.count
        for change in ({"dst_a_port": listener.getsockname()[1]}, {"source_policy": "mapping"}):
            running.live.change(change)
            running.bridge_one()
        assert observer.count == asked


def test_the_policy_of_sources_changes_while_the_bridge_runs() -> None:
    """The bridge checks senders from the change on, and stops with the change back."""
    restricted = of_peers(_QUIET, hardware={"sources": ("10.0.0.9",)}, basestation={"sources": ("10.0.0.8",)})
    with _Running(restricted, source_policy="any") as running:
        for policy, published, dropped in (("any", 1, 0), ("mapping", 1, 1), ("any", 2, 1)):
            running.live.change({"source_policy": policy})
            running.bridge_one()
            assert running.bridge.account.published.total() == published
            assert running.bridge.account.dropped["unknown_source"] == dropped


def test_the_receive_buffer_changes_while_the_bridge_runs() -> None:
    """The kernel has the new size at once."""
    with _Running(receive_buffer=20_000) as running:
        before = running.bridge.socket_state().size
        running.live.change({"receive_buffer": 40_000})
        assert running.bridge.socket_state().size == pytest.approx(2 * before, rel=0.1)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        (
            {"dst_a_port": 7001, "listen_port": 5001},
            "'listen_port' is read-only; restart the node with -p listen_port:=",
        ),
        ({"dst_a_port": 7001, "dst_b_port": 0}, "'dst_b_port' is 0; a UDP port is a number from 1 to 65535"),
        ({"dst_a_port": 7001, "forward_policy": "none"}, "'forward_policy' is 'none'; it must be one of mapping, all"),
        ({"dst_a_port": 7001, "dst_ip": "no host"}, "'no host' is neither an IP address nor the name of a host"),
        ({"dst_a_port": 7001, "dst_ip": 7}, "'dst_ip' is 7; it must be of type str"),
        ({"dst_a_port": 7001, "dst_ipp": "::"}, "unknown parameter 'dst_ipp'; did you mean 'dst_ip'"),
        ({"dst_a_port": 7001, "use_sim_time": True}, "'use_sim_time' cannot change"),
    ],
)
def test_a_change_that_is_partly_wrong_changes_nothing(changes: dict[str, Any], reason: str) -> None:
    """The error names the wrong parameter; the right ones beside it keep their values."""
    with _Running() as running:
        before = dict(running.live.values)
        with pytest.raises(SetupError, match=reason):
            running.live.change(changes)
        assert running.live.values == before
        assert {one.addresses[0][1] for one in running.bridge._ends.destinations.values()} == {6000, 6001}


def test_a_change_is_logged(caplog: pytest.LogCaptureFixture) -> None:
    """The log has the new value and the one before."""
    with _Running() as running, caplog.at_level("INFO", _LOGGER.name):
        running.live.change({"dst_ip": "127.0.0.2"})
    assert "parameter dst_ip is now 127.0.0.2 (it was 127.0.0.1)" in caplog.messages


def test_values_that_stay_are_not_logged(caplog: pytest.LogCaptureFixture) -> None:
    """`ros2 param load` sets all parameters, those of every node too; the log tells what has changed."""
    with _Running() as running, caplog.at_level(logging.INFO):
        running.live.change({"dst_ip": "127.0.0.1", "use_sim_time": False, "dst_a_port": 6123})
    assert [record.getMessage() for record in caplog.records if "parameter" in record.getMessage()] == [
        "parameter dst_a_port is now 6123 (it was 6000)"
    ]


def test_a_node_that_starts_refuses_changes() -> None:
    """Before the bridge is there, a change is refused."""
    live = LiveParameters(REGISTRY, parameters.read(REGISTRY, {}), _LOGGER)
    with pytest.raises(SetupError, match="starting; try again"):
        live.change({"dst_ip": "127.0.0.2"})


def test_descriptions_say_what_ros_2_may_set() -> None:
    """Each parameter has its description, range and choices, and says if it is read-only."""
    descriptors = LiveParameters(REGISTRY, parameters.read(REGISTRY, {}), _LOGGER).descriptors
    assert descriptors.keys() == parameters.defaults(REGISTRY).keys()
    port, policy = descriptors["dst_b_port"], descriptors["forward_policy"]
    assert (port.integer_range[0].from_value, port.integer_range[0].to_value) == (1, 65535)
    assert port.description == "UDP port of the peer hardware"
    assert policy.additional_constraints == "one of mapping, all"
    read_only = {name for name, descriptor in descriptors.items() if descriptor.read_only}
    assert read_only == {"listen_port", "listen_address", "max_datagram"}


def _without_forwards() -> Registry:
    registry = _QUIET
    for handler in registry.handlers:
        if handler.route.forward:
            registry = changed(registry, handler.route.name, forward=())
    return registry
