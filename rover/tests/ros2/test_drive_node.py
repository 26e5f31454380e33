"""``roverlink drive`` between a real rclpy controller and the bridge."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest
from needs import NO_RCLPY
from polling import wait_until
from programs import Start
from repeating import repeated

pytest.importorskip("rclpy", reason=NO_RCLPY)

from judge import Bridge, Judge, interface
from rclpy.qos import DurabilityPolicy, QoSProfile

_STATE = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def _twist(linear: float, angular: float) -> Any:
    made = interface("geometry_msgs/msg/Twist")()
    made.linear.x, made.angular.z = linear, angular
    return made


class _Controller:
    """A node with typed publishers, whose stamps are those of its clock."""

    def __init__(self, judge: Judge) -> None:
        self._judge, self._publishers = judge, dict[str, Any]()

    def publish(self, topic: str, message: Any) -> None:
        """Publish a message, with the time of now if it has a header."""
        if topic not in self._publishers:
            self._publishers[topic] = self._judge.node.create_publisher(type(message), topic, 10)
        if hasattr(message, "header"):
            message.header.stamp = self._judge.node.get_clock().now().to_msg()
        self._publishers[topic].publish(message)


def _path(length: float) -> Any:
    made = interface("nav_msgs/msg/Path")()
    made.header.frame_id = "map"
    for x in (0.0, length):
        pose = interface("geometry_msgs/msg/PoseStamped")()
        pose.pose.position.x = x
        made.poses.append(pose)
    return made


def _pose() -> Any:
    made = interface("nav_msgs/msg/Odometry")()
    made.header.frame_id, made.child_frame_id = "map", "base_link"
    return made


def test_velocities_and_paths_of_a_real_node(
    judge: Judge, join: Callable[..., Judge], bridge: Callable[..., Bridge], start: Start, middleware: str
) -> None:
    """Twist, TwistStamped and Path become typed commands on the topic and datagrams; MANUAL is one stop."""
    running = bridge()
    commands = judge.hear("/drive_motor", "comms/msg/DrivingBoardMotorMessage")
    states = judge.hear("/drive/state", "std_msgs/msg/String", _STATE)
    mode = 1
    with repeated(lambda _: running.send(control_mode={"mode": mode}), 0.05):
        drive = start(
            *("drive", "--middleware", middleware, "--json", "--ros-args"),
            *("-p", "mode_timeout:=60.0", "-p", "timeout:=5.0", "-p", "pose_timeout:=5.0"),
        )
        drive.wait_for("while /control_mode is AUTO")

        def heard(is_it: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
            return wait_until(lambda: next((one for one in reversed(commands.values) if is_it(one)), None), "a command")

        first = join("first_controller")
        controller = _Controller(first)
        with repeated(lambda _: controller.publish("/cmd_vel", _twist(0.4, 0.2)), 0.05):
            left = heard(lambda one: one["distance_to_go"] > 0.1)
        assert left["turning_radius"] == pytest.approx(2.0)
        board = wait_until(
            lambda: next(
                (one.drive_motor for one in running.arrived("hardware") if one.drive_motor.turning_radius), None
            ),
            "a datagram",
        )
        assert board.turning_radius == pytest.approx(2.0)

        first.close()
        controller = _Controller(join("second_controller"))
        stamped = interface("geometry_msgs/msg/TwistStamped")()
        stamped.header.frame_id, stamped.twist = "base_link", _twist(0.4, -0.2)
        with repeated(lambda _: controller.publish("/cmd_vel", stamped), 0.05):
            right = heard(lambda one: one["turning_radius"] < 0)
        assert right["turning_radius"] == pytest.approx(-2.0)

        with repeated(lambda _: controller.publish("/odometry/global", _pose()), 0.05):
            path = _path(9.0)
            with repeated(lambda _: controller.publish("/path", path), 0.5):
                straight = heard(lambda one: one["turning_radius"] == 0 and one["distance_to_go"] > 0.1)
            assert straight["distance_to_go"] <= 0.4
            wait_until(lambda: {"data": "following"} in states.values, "the state")
            mode = 0
            drive.wait_for("manual: control_mode is MANUAL")
            wait_until(lambda: commands.values[-1]["distance_to_go"] == 0, "the stop")
        assert drive.interrupt() == 0
    entries = [json.loads(line) for line in drive.output]
    distances = [one["distance_to_go"] for one in entries if "distance_to_go" in one]
    assert [one["reason"] for one in entries[-2:]] == ["control_mode is MANUAL", "this program ends"]
    assert entries[-3]["distance_to_go"] == 0
    assert distances[-2] > 0
