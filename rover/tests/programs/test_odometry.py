"""``roverlink odometry``: messages of a driving board and an IMU become odometry, also with a bridge between them."""

from __future__ import annotations

import json
import math
import socket
from collections.abc import Iterator
from contextlib import ExitStack, suppress

import pytest
from needs import needs_dds
from node_in_memory import SECOND, NodeInMemory, hear
from polling import wait_until
from programs import Start
from repeating import repeated
from roverkit.odometry.odometry_messages import UNKNOWN_VARIANCE
from roverkit.odometry.odometry_parameters import OdometryParameters
from roverkit.odometry.odometry_rows import WHEELS, OdometryRows
from roverkit.odometry.wheel_odometry_node import OdometryNode
from running import Bridge

from generated.messages import (
    DrivingBoardDiagnostics,
    DrivingBoardMotorMessage,
    DrivingBoardMotorPeriodicProgress,
    MotorInformation,
)
from generated.registry import REGISTRY
from roverlink.runtime import Qos
from roverlink.runtime.convert.rotations import angles
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import Time
from roverlink.runtime.interfaces.geometry_msgs import Vector3
from roverlink.runtime.interfaces.nav_msgs import Odometry
from roverlink.runtime.interfaces.sensor_msgs import Imu
from roverlink.runtime.interfaces.tf2_msgs import TFMessage
from roverlink.runtime.middleware import NodeIdentity, open_middleware

_TICK = SECOND // 20


def _yaw(odometry: Odometry) -> float:
    return angles(odometry.pose.pose.orientation)[2]


@pytest.mark.slow
@needs_dds
def test_odometry_follows_a_simulated_rover(bridge: Bridge, start: Start, peer: socket.socket) -> None:
    """Commands go to the rover over UDP, its reports come back, and the pose on both topics is near the true one."""
    peer.settimeout(0.1)
    with ExitStack() as held:
        node = held.enter_context(open_middleware("dds", NodeIdentity("controller")))
        truth, found = (hear(node, f"/{name}", Odometry) for name in ("ground_truth/odometry", "odometry/wheel"))
        transforms = hear(node, "/tf", TFMessage)
        commands = node.publisher("/drive_motor", DrivingBoardMotorMessage, Qos())
        _, port = bridge(parameters=[f"dst_b_port:={peer.getsockname()[1]}"], middleware="dds")
        odometry = start("odometry", "--middleware", "dds", "--json")
        odometry.wait_for("waiting for reports on /drive_progress; odometry on /odometry/wheel")
        rover = start("simulate-rover", "--to", f"127.0.0.1:{port}", "--listen", 0, "--middleware", "dds")
        boards = "127.0.0.1", int(rover.wait_for("its boards listen on UDP port ").rpartition(" ")[2])

        def forward(_: int) -> None:
            with suppress(TimeoutError):
                peer.sendto(peer.recv(2000), boards)

        held.enter_context(repeated(forward, 0))
        wait_until(lambda: truth and found, "the topics")

        # The bridge's deadman stops the rover half a second after the last command.
        def command(_: int) -> None:
            commands.publish([cdr.encode(DrivingBoardMotorMessage(0.5, 1.5))])

        with repeated(command, 0.2):
            wait_until(lambda: truth[-1].pose.pose.position.y > 0.5, "the rover on its arc")
        wait_until(lambda: truth[-1].twist.twist.linear.x == 0, "the stop")
        count = len(found)
        wait_until(lambda: len(found) > count + 5, "odometry of the standing rover")
        assert rover.interrupt() == 0
        assert odometry.interrupt() == 0
    real, pose = truth[-1].pose.pose.position, found[-1].pose.pose.position
    deviation = math.sqrt(found[-1].pose.covariance[0] + found[-1].pose.covariance[7])
    assert (truth[-1].header.frame_id, found[-1].header.frame_id) == ("map", "odom")
    # The frame odom is the map here, because the rover starts at its origin. A loaded computer delays the messages, and
    # they have no stamps.
    assert math.hypot(pose.x - real.x, pose.y - real.y) < 4 * deviation + 0.5
    assert abs(_yaw(found[-1]) - _yaw(truth[-1])) < 0.3
    assert math.hypot(pose.x, pose.y) > 0.6
    assert transforms[-1].transforms[0].child_frame_id == "base_link"
    assert {*json.loads(odometry.output[-1])} >= {"stamp", "x", "y", "yaw", "speed", "yaw_rate", "covariance"}


class _Node(NodeInMemory):
    """The node with its odometry."""

    def __init__(self, held: ExitStack, *parameters: str) -> None:
        super().__init__(held, "odometry", ["use_sim_time:=true", *parameters], OdometryParameters)
        self.node = OdometryNode(self.connection, OdometryRows(REGISTRY), self.parameters, self.logger, as_json=False)
        self.found = self.hear("/odometry/wheel", Odometry)
        self.transforms = self.hear("/tf", TFMessage)
        self.node.receive()

    def drive(self, metres: float, rate: float | None = 0.0, speed: float = 0.5, before: float = 0.0) -> None:
        """Report the progress on a command of 10 m, with an IMU that measures an angular velocity in rad/s, or none."""
        for step in range(1, round(metres / speed / 0.05) + 1):
            self.pass_time(_TICK)
            if rate is not None:
                self.publish("/imu/data_raw", Imu(angular_velocity=Vector3(0, 0, rate)))
            self.publish("/drive_progress", DrivingBoardMotorPeriodicProgress(10 - before - step * speed * 0.05))


@pytest.fixture
def node() -> Iterator[_Node]:
    """The node, with its parameters' defaults."""
    with ExitStack() as held:
        yield _Node(held)


def _begin(node: _Node, distance: float = 10.0, radius: float = 0.0) -> None:
    node.publish("/imu/data_raw", Imu())
    node.publish("/drive_progress", DrivingBoardMotorPeriodicProgress())
    node.publish("/drive_motor", DrivingBoardMotorMessage(distance, radius))


def test_progress_becomes_a_pose_with_a_covariance(node: _Node) -> None:
    """Frames, stamps and the transform are those of REP 105; what is not measured has a large variance."""
    _begin(node)
    node.drive(2.0)
    last = node.found[-1]
    assert (last.header.frame_id, last.child_frame_id) == ("odom", "base_link")
    assert last.header.stamp == Time.since_1970(node.now)
    assert last.pose.pose.position.x == pytest.approx(2.0, abs=1e-3)
    assert last.twist.twist.linear.x == pytest.approx(0.5, abs=0.02)
    covariance = last.pose.covariance
    assert covariance[0] == pytest.approx(2 * 0.05**2 + (2 * 0.02) ** 2, rel=0.1)
    assert 0 < covariance[7] < covariance[0]
    assert [covariance[7 * axis] for axis in (2, 3, 4)] == [UNKNOWN_VARIANCE] * 3
    assert all(covariance[6 * row + column] == covariance[6 * column + row] for row in range(6) for column in range(6))
    (transform,) = node.transforms[-1].transforms
    assert (transform.header, transform.child_frame_id) == (last.header, "base_link")
    assert transform.transform.translation.x == last.pose.pose.position.x
    assert transform.transform.rotation == last.pose.pose.orientation
    assert node.log == []


def test_without_an_imu_the_command_tells_the_turn(node: _Node) -> None:
    """The log says so once, and the covariance of the yaw is larger; a radius that is too small is limited."""
    _begin(node, radius=0.1)
    node.drive(1.0, rate=None)
    with_steering = node.found[-1]
    assert _yaw(with_steering) == pytest.approx(1.0, abs=0.35)
    assert with_steering.pose.covariance[35] > 100 * 1e-6
    assert node.log == ["no angular velocity comes from the IMU; the turn is that of the steering"]


def test_the_motors_tell_that_the_rover_rolls_on(node: _Node) -> None:
    """After a stop nothing is left, and only the motors report; one that has failed does not count."""

    def motors(rpm: float) -> None:
        wheels = {name: MotorInformation(state=1, rpm=-rpm if "right" in name else rpm) for name in WHEELS}
        wheels["back_left_motor"] = MotorInformation(state=3, rpm=9e9)
        node.publish("/drive_diag", DrivingBoardDiagnostics(state=1, **wheels))

    _begin(node)
    for step in range(20):
        motors(50)
        node.drive(0.025, before=step * 0.025)
    node.publish("/drive_motor", DrivingBoardMotorMessage())
    for rpm in (50, 25, 0, 0, 0, 0):
        node.pass_time(_TICK)
        motors(rpm)
        node.publish("/drive_progress", DrivingBoardMotorPeriodicProgress())
    assert node.found[-1].pose.pose.position.x == pytest.approx(0.5 + 0.05, abs=0.02)
    assert node.found[-1].twist.twist.linear.x == 0


def test_a_silent_board_makes_the_position_uncertain(node: _Node) -> None:
    """The last pose is repeated with a growing covariance, and the log says it once."""
    _begin(node)
    node.drive(1.0)
    count, certain = len(node.found), node.found[-1].pose.covariance[0]
    for _ in range(8):
        node.pass_time(_TICK)
        node.node.tick()
    assert len(node.found) == count
    for _ in range(20):
        node.pass_time(_TICK)
        node.node.tick()
    last = node.found[-1]
    assert last.header.stamp == Time.since_1970(node.now)
    assert last.pose.pose.position.x == pytest.approx(1.0, abs=1e-3)
    assert last.pose.covariance[0] > certain + 0.4
    assert node.log == ["the driving board reports nothing; the position becomes uncertain"]


def test_parameters_name_the_frames_and_leave_the_transform_out() -> None:
    """Another program, such as robot_localization, then publishes it; larger slip makes a larger covariance."""
    with ExitStack() as held:
        node = _Node(held, "publish_tf:=false", "odom_frame:=world", "base_frame:=rover", "slip:=0.1", "mean_slip:=0.0")
        _begin(node)
        node.drive(1.0)
        assert node.transforms == []
        assert (node.found[-1].header.frame_id, node.found[-1].child_frame_id) == ("world", "rover")
        assert node.found[-1].pose.covariance[0] == pytest.approx(0.1**2, rel=0.1)
        node.parameters.change({"slip": 0.0})
        before = node.found[-1].pose.covariance[0]
        node.drive(1.0, before=1.0)
        assert node.found[-1].pose.covariance[0] == pytest.approx(before, rel=0.01)


@pytest.mark.parametrize(
    ("topic", "message", "expected"),
    [
        ("/imu/data_raw", Imu(angular_velocity=Vector3(0, 0, math.nan)), "the angular velocity of an IMU is nan"),
        ("/imu/data_raw", Imu(angular_velocity=Vector3(0, 0, 1e300)), "the angular velocity of an IMU is 1e+300"),
        ("/drive_progress", DrivingBoardMotorPeriodicProgress(math.inf), "distance_left is inf"),
        ("/drive_progress", DrivingBoardMotorPeriodicProgress(1e30), "distance_left is 1"),
        ("/drive_motor", DrivingBoardMotorMessage(math.nan, 0.0), "the driving board cannot execute"),
    ],
)
def test_values_that_are_no_numbers_are_told_and_counted(
    node: _Node, topic: str, message: Message, expected: str
) -> None:
    """The odometry goes on."""
    _begin(node)
    node.drive(1.0)
    for _ in range(3):
        node.publish(topic, message)
    node.drive(1.0, before=1.0)
    assert all(line.startswith(f"ignoring a message: {expected}") for line in node.log)
    assert sum(node.node.reasons.counts.values()) == 3
    assert node.found[-1].pose.pose.position.x == pytest.approx(2.0, abs=1e-3)
