"""Starting, stopping and joining late, as the ROS 2 graph sees it."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable

from judge import Bridge, Heard, Judge, interface, repeat
from polling import wait_until

from generated.registry import REGISTRY

_IMU = "comms/msg/ImuSensorInformation"
_TARGET = "comms/msg/ArmBoardTargetMovement"
_PROMPT_S = 8.0  # it takes half a second; a node that does not say that it leaves stays on the graph for 10 s


def test_bridges_and_nodes_come_and_go(join: Callable[..., Judge], bridge: Callable[..., Bridge]) -> None:
    """Nodes that stay hear each new bridge, one that joins late too, and their commands cross.

    After SIGINT and SIGTERM, the bridge leaves the graph at once, though the nodes still subscribe. A bridge that was
    killed is replaced by one of the same name before it has faded from the graph.
    """
    early = join("early")
    heard = early.hear("/imu_data", _IMU)
    running = bridge()
    _cross(running, early, heard, 1.0)
    late = join("late")
    _cross(running, late, late.hear("/imu_data", _IMU), 2.0)
    late.close()
    for number, value in ((signal.SIGINT, 3.0), (signal.SIGTERM, 4.0)):
        early.wait_for_node("/udp_forwarder")
        started = time.monotonic()
        assert running.program.interrupt(number) == 0
        wait_until(lambda: not early.nodes() and not early.node.count_publishers("/imu_data"), "the node to leave")
        assert time.monotonic() - started < _PROMPT_S
        running = bridge()
        _cross(running, early, heard, value)
    running.program.kill()
    _cross(bridge(), early, heard, 5.0)


def _cross(running: Bridge, judge: Judge, heard: Heard, value: float) -> None:
    """Send a datagram until the judge hears it, and publish a command until it arrives at the peer."""
    repeat(
        lambda: running.send(imu_info={"accel_x": value}),
        lambda: heard.values and heard.values[-1]["accel_x"] == value,
        f"a message with {value}",
    )
    publisher = judge.node.create_publisher(interface(_TARGET), "/arm_target", 10)
    handler = next(one for one in REGISTRY.handlers if one.route.topic == "arm_target")

    def arrived() -> bool:
        envelopes = running.arrived(handler.route.peer)
        return any(envelope.WhichOneof(REGISTRY.oneof) == handler.route.name for envelope in envelopes)

    repeat(lambda: publisher.publish(interface(_TARGET)()), arrived, "a command at the peer")
    # On the thread that spins: an executor that just then collects the publisher's events ends with an InvalidHandle.
    judge.on_thread(lambda: judge.node.destroy_publisher(publisher))
