"""Nodes of ROS 2 whose QoS differs from the bridge's, or that only some subscriptions match."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest
from judge import Bridge, Judge, interface
from polling import wait_until
from programs import Start as Run
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

Start = Callable[..., Bridge]

_IMU = "comms/msg/ImuSensorInformation"
_MOTOR = "comms/msg/DrivingBoardMotorMessage"
_BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
_LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def test_nodes_that_cannot_match_are_told(judge: Judge, bridge: Start) -> None:
    """A best-effort publisher of commands and a subscription that wants old messages: by node and policy in the log.

    The status of the publisher's row in /diagnostics counts it; tests/runtime/test_qos_watch.py lets it leave.
    """
    heard = judge.hear("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
    running = bridge()
    judge.node.create_publisher(interface(_MOTOR), "/drive_motor", _BEST_EFFORT)
    judge.hear("/imu_data", _IMU, _LATCHED)
    running.program.wait_for("/drive_motor: no messages come from a publisher of /judge (reliability: ")
    running.program.wait_for("/imu_data: a subscription of /judge gets no messages (durability: ")

    def count() -> str | None:
        statuses = heard.values[-1]["status"] if heard.values else []
        row = next((one for one in statuses if one["name"].endswith(": drive_motor")), {"values": []})
        return next((pair["value"] for pair in row["values"] if pair["key"] == "qos_mismatches"), None)

    wait_until(lambda: count() == "1", "the mismatch in /diagnostics")


@pytest.mark.parametrize("profile", [_BEST_EFFORT, _LATCHED, QoSProfile(depth=10)], ids=["fast", "latched", "default"])
def test_echo_hears_any_publisher(judge: Judge, start: Run, middleware: str, profile: QoSProfile) -> None:
    """`roverlink echo` adapts its QoS to the publisher; of a latched one, it prints what was published before."""
    publisher = judge.node.create_publisher(interface(_MOTOR), "/drive_motor", profile)
    message = interface(_MOTOR)(distance_to_go=2.5)
    publisher.publish(message)
    echo = start("echo", "drive_motor", "--json", "--count", 1, "--middleware", middleware)
    if profile is not _LATCHED:
        wait_until(publisher.get_subscription_count, "echo")
        publisher.publish(message)
    assert json.loads(echo.wait_for("distance_to_go", echo.output))["distance_to_go"] == 2.5
    assert echo.end() == 0


def test_pub_waits_for_a_subscription(judge: Judge, start: Run, middleware: str) -> None:
    """`roverlink pub` publishes a message of a row, or of a standard type, once a node listens, and ends with 0."""
    for topic, type_name, said, options in (
        ("drive_motor", _MOTOR, {"distance_to_go": 1.5, "turning_radius": -2.25}, ()),
        ("chatter", "std_msgs/msg/String", {"data": "Grüße"}, ("--type", "std_msgs/msg/String")),
    ):
        words = (topic, json.dumps(said), *options, "--once", "--wait", 60)
        pub = start("pub", *words, "--middleware", middleware)
        judge.hear(f"/{topic}", type_name).wait_for(said)
        assert pub.end() == 0
