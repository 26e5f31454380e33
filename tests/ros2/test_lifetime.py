"""Starting, stopping and joining late, as the ROS 2 graph sees it."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable

import pytest
from judge import Bridge, Judge, interface, repeat
from polling import wait_until

from generated.registry import REGISTRY

Start = Callable[..., Bridge]

_IMU = "comms/msg/ImuSensorInformation"
_TARGET = "comms/msg/ArmBoardTargetMovement"
_PROMPT_S = 8.0  # it takes half a second; a node that does not say that it leaves stays on the graph for 10 s


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=lambda number: number.name)
def test_a_signal_ends_the_bridge_and_takes_it_off_the_graph(
    judge: Judge, bridge: Start, number: signal.Signals
) -> None:
    """Exit code 0, and the node and its topics are gone at once, though the judge still subscribes."""
    running = bridge()
    heard = judge.hear("/imu_data", _IMU)
    repeat(lambda: running.send(imu_info={}), lambda: heard.values, "a first message")
    judge.wait_for_node("/udp_forwarder")
    started = time.monotonic()
    assert running.program.interrupt(number) == 0
    wait_until(lambda: not judge.nodes() and not judge.node.count_publishers("/imu_data"), "the node to leave")
    assert time.monotonic() - started < _PROMPT_S


def test_a_node_that_joins_late_hears_and_is_heard(join: Callable[..., Judge], bridge: Start) -> None:
    """A second node that starts while messages flow gets them as the first one does, and its commands cross."""
    running, early = bridge(), join("early").hear("/imu_data", _IMU)
    repeat(lambda: running.send(imu_info={"accel_x": 1.0}), lambda: early.values, "a message for the first node")
    late = join("late")
    heard = late.hear("/imu_data", _IMU)
    repeat(lambda: running.send(imu_info={"accel_x": 2.0}), lambda: heard.values, "a message for the second node")
    assert heard.values[0]["accel_x"] == 2.0
    _command(late, running)


def test_a_bridge_that_starts_again_finds_the_nodes_that_stayed(judge: Judge, bridge: Start) -> None:
    """After a restart, the subscriptions and publishers of a node that kept running work with the new bridge."""
    heard = judge.hear("/imu_data", _IMU)
    for value in (1.0, 2.0):
        running = bridge()
        repeat(
            lambda running=running, value=value: running.send(imu_info={"accel_x": value}),
            lambda value=value: heard.values and heard.values[-1]["accel_x"] == value,
            f"a message of the bridge with {value}",
        )
        _command(judge, running)
        assert running.program.interrupt() == 0


def test_a_bridge_that_was_killed_is_replaced(judge: Judge, bridge: Start) -> None:
    """After SIGKILL, a new bridge under the same name is heard before the old one has faded from the graph."""
    heard = judge.hear("/imu_data", _IMU)
    killed = bridge()
    repeat(lambda: killed.send(imu_info={"accel_x": 1.0}), lambda: heard.values, "a message of the first bridge")
    killed.program.kill()
    running = bridge()
    repeat(
        lambda: running.send(imu_info={"accel_x": 2.0}),
        lambda: heard.values[-1]["accel_x"] == 2.0,
        "a message of the second bridge",
    )


def _command(judge: Judge, running: Bridge) -> None:
    """Publish a command until it arrives at the peer."""
    publisher = judge.node.create_publisher(interface(_TARGET), "/arm_target", 10)
    handler = next(one for one in REGISTRY.handlers if one.route.topic == "arm_target")

    def arrived() -> bool:
        envelopes = running.arrived(handler.route.peer)
        return any(envelope.WhichOneof(REGISTRY.oneof) == handler.route.name for envelope in envelopes)

    repeat(lambda: publisher.publish(interface(_TARGET)()), arrived, "a command at the peer")
    judge.node.destroy_publisher(publisher)
