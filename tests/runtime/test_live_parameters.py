"""Parameters of a running bridge: each change is checked and applied as a whole."""

from __future__ import annotations

from typing import Any

import pytest
from bridge_rig import LOGGER, QUIET, Rig, end, envelope, listener, of_peers, port_of

from generated.registry import REGISTRY
from roverlink.runtime import SetupError
from roverlink.runtime.ros_arguments import parameters
from roverlink.runtime.ros_arguments.live_parameters import LiveParameters
from roverlink.runtime.text.host_names import LEARN

_IMU, _MODE = envelope(imu_info={}), envelope(control_mode={})


def test_hosts_change_while_the_bridge_runs() -> None:
    """A new host, another port, `learn`, and back: each from the next datagram on."""
    with listener() as sock, listener() as other:
        registry = of_peers(QUIET, hardware=end("hw", "127.0.0.1", port_of(sock)))
        changes: list[tuple[dict[str, Any], Any]] = [
            ({}, sock),
            ({"hw_port": port_of(other)}, other),
            ({"hw_host": LEARN, "hw_port": 0}, sock),
            ({"hw_host": "127.0.0.1,127.0.0.2", "hw_port": port_of(other)}, other),
        ]
        with Rig(registry) as rig:
            for change, told in changes:
                rig.live.change(change)
                if LEARN in change.values():
                    assert {state.state for state in rig.bridge.link_states().values()} >= {"not_learned"}
                    rig.receive(_IMU, via=sock)
                datagram = rig.publish("drive_motor")
                assert told.recv(2000) == datagram
                assert change.items() <= rig.live.values.items()


def test_the_policy_of_sources_changes_while_the_bridge_runs() -> None:
    """The bridge checks senders from the change on, and stops with the change back."""
    restricted = of_peers(QUIET, hardware={"sources": ("10.0.0.9",)}, basestation={"sources": ("10.0.0.8",)})
    with Rig(restricted, source_policy="any") as rig:
        for policy, published, dropped in (("any", 1, 0), ("mapping", 1, 1), ("any", 2, 1)):
            rig.live.change({"source_policy": policy})
            rig.receive(_IMU)
            account = rig.account
            assert (account.published.total(), account.dropped["unknown_source"]) == (published, dropped)


def test_the_receive_buffer_changes_while_the_bridge_runs() -> None:
    """The kernel has the new size at once."""
    with Rig(receive_buffer=20_000) as rig:
        before = rig.bridge.socket_state().size
        rig.live.change({"receive_buffer": 40_000})
        assert rig.bridge.socket_state().size == pytest.approx(2 * before, rel=0.1)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"listen_port": 5001}, "'listen_port' is read-only; restart the node with -p listen_port:="),
        ({"dst_a_port": 0}, "'dst_a_port' is 0; a UDP port is a number from 1 to 65535"),
        ({"dst_ipp": "::"}, "unknown parameter 'dst_ipp'; did you mean 'dst_ip'"),
        ({"use_sim_time": True}, "read-only; restart the node with -p use_sim_time:=true"),
        ({"hw_host": "no host"}, "'hw_host' is 'no host'; 'no host' is neither an IP address nor the name of a host"),
        ({"hw_host": "10.0.0.1, learn"}, "'learn' cannot stand beside other hosts"),
        ({"hw_host": 7}, "'hw_host' is 7; it must be of type str"),
        ({"hw_port": 0}, "the parameter 'hw_port' is 0, but 'hw_host' is not 'learn'; set the UDP port of hardware"),
        ({"source_policy": "none"}, "'source_policy' is 'none'; it must be one of mapping, any"),
    ],
)
def test_a_change_that_is_partly_wrong_changes_nothing(changes: dict[str, Any], reason: str) -> None:
    """The error names the wrong parameter; the right ones beside it keep their values."""
    with Rig(of_peers(QUIET, hardware=end("hw", "127.0.0.1"))) as rig:
        values, states = dict(rig.live.values), rig.bridge.link_states()
        with pytest.raises(SetupError, match=reason):
            rig.live.change({"forward_policy": "all", "dst_a_port": 7001, **changes})
        assert (rig.live.values, rig.bridge.link_states()) == (values, states)


def test_a_change_is_logged_with_the_value_before(caplog: pytest.LogCaptureFixture) -> None:
    """`ros2 param load` sets all parameters, those of every node too; the log tells what has changed."""
    with Rig(dst_a_port=6000) as rig, caplog.at_level("INFO", LOGGER.name):
        rig.live.change({"dst_ip": "127.0.0.1", "use_sim_time": False, "dst_a_port": 6123})
    assert [message for message in caplog.messages if "parameter" in message] == [
        "parameter dst_a_port is now 6123 (it was 6000)"
    ]


def test_a_node_that_starts_refuses_changes() -> None:
    """Before the bridge is there, a change is refused."""
    live = LiveParameters(REGISTRY, parameters.read(REGISTRY, {}), LOGGER)
    with pytest.raises(SetupError, match="starting; try again"):
        live.change({"dst_ip": "127.0.0.2"})


def test_descriptions_say_what_ros_2_may_set() -> None:
    """Each parameter has its description, range and choices, and says if it is read-only."""
    descriptors = LiveParameters(REGISTRY, parameters.read(REGISTRY, {}), LOGGER).descriptors
    assert descriptors.keys() == parameters.defaults(REGISTRY).keys()
    port, policy = descriptors["dst_b_port"], descriptors["forward_policy"]
    assert (port.integer_range[0].from_value, port.integer_range[0].to_value) == (1, 65535)
    assert port.description == "UDP port of the peer hardware"
    assert policy.additional_constraints == "one of mapping, all"
    read_only = {name for name, descriptor in descriptors.items() if descriptor.read_only}
    assert read_only == {"listen_port", "listen_address", "max_datagram", "native_core", "use_sim_time"}
