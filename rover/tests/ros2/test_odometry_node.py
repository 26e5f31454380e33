"""``roverlink odometry`` between a bridge and a real rclpy node, which reads the pose and the transform."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
from needs import NO_RCLPY
from polling import wait_until
from programs import Start
from repeating import repeated

pytest.importorskip("rclpy", reason=NO_RCLPY)

from judge import Bridge, Judge, interface


def test_a_real_node_reads_odometry_and_the_transform(
    judge: Judge, bridge: Callable[..., Bridge], start: Start, middleware: str
) -> None:
    """The command is that of a typed publisher, the reports are datagrams; both topics have the same pose and stamp."""
    running = bridge()
    odometry = judge.hear("/odometry/wheel", "nav_msgs/msg/Odometry")
    transforms = judge.hear("/tf", "tf2_msgs/msg/TFMessage")
    commands = judge.node.create_publisher(interface("comms/msg/DrivingBoardMotorMessage"), "/drive_motor", 10)
    program = start("odometry", "--middleware", middleware)
    program.wait_for("odometry on /odometry/wheel")
    left = distance = 0.0

    def report(_: int) -> None:
        """Send what the boards send: a gyroscope that turns to the left while the rover drives."""
        nonlocal left
        left = left - 0.01 if left > 0.01 else distance
        running.send(imu_info={"gyro_z": math.degrees(0.1) if left else 0.0, "accel_z": 9.81, "state": 1})
        running.send(drive_progress={"distance_left": left})

    with repeated(report, 0.05):
        wait_until(lambda: odometry.values and transforms.values, "odometry of the standing rover")
        command = interface("comms/msg/DrivingBoardMotorMessage")()
        command.distance_to_go, command.turning_radius = 2.0, 5.0
        # Until the turn, which shows that the program has discovered the publisher; the bridge can be earlier.
        with repeated(lambda _: commands.publish(command), 0.2):
            wait_until(
                lambda: any(one.drive_motor.distance_to_go for one in running.arrived("hardware")), "the command"
            )
            distance = 2.0  # what is left of it falls, or else a turn would be the bias of a gyroscope at rest
            wait_until(lambda: any(one["twist"]["twist"]["angular"]["z"] > 0.05 for one in odometry.values), "the turn")
            wait_until(lambda: any(one["pose"]["pose"]["position"]["x"] > 0.1 for one in odometry.values), "the way")
        last = odometry.values[-1]
        wait_until(
            lambda: any(one["transforms"][0]["header"] == last["header"] for one in transforms.values), "its transform"
        )
    assert program.interrupt() == 0
    assert (last["header"]["frame_id"], last["child_frame_id"]) == ("odom", "base_link")
    transform = next(
        one["transforms"][0] for one in transforms.values if one["transforms"][0]["header"] == last["header"]
    )
    assert transform["child_frame_id"] == "base_link"
    assert transform["transform"]["translation"] == last["pose"]["pose"]["position"]
    assert transform["transform"]["rotation"] == last["pose"]["pose"]["orientation"]
    assert last["pose"]["pose"]["orientation"]["z"] > 0
    assert last["pose"]["covariance"][0] > 0
