"""A mission with all programs on its way to the boards, and a simulated rover at the end of them.

`roverlink mission run` sends goals to an action server that stands in for Nav2. `roverlink drive` makes commands of its
velocities, and the bridge sends them to the driving board, a model whose wheels slip. The pose is that of the model, or
of `roverlink odometry` and `roverlink fuse`, from datagrams of the boards and landmarks that a camera sees. The time is
that of a simulation, which waits for the programs: on a busy computer, none of them is late.
"""

from __future__ import annotations

import json
import math
import random
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from judge import Bridge, Judge, interface  # skips this module where there is no rclpy
from needs import NO_GTSAM, NO_OPENCV
from polling import wait_until
from programs import Start

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("gtsam", reason=NO_GTSAM)

from nav2_stand_in import transforms  # skips this module where nav2_msgs is missing

# isort: split

from nav2_msgs.action import NavigateToPose
from rclpy.action import ActionServer, CancelResponse
from rclpy.serialization import deserialize_message
from rclpy.time import Time
from roverkit.driving.arcs import PlanarPose
from roverkit.driving.board_commands import BoardCommand
from roverkit.simulation.rover_datagrams import RoverDatagrams
from roverkit.simulation.rover_model import Measurement, RoverModel

from generated.registry import REGISTRY
from rover.tests.driving.simulated_tracker import SimulatedTracker, field, standing, write_field
from roverlink.runtime.core import cdr

_STEP_S, _PERIOD_S = 0.02, 0.01  # of the simulation, and of the computer if the programs are fast enough
_BEGIN_NS = 10**12
_LATE_NS, _OLD_NS, _PATIENCE_S = 200_000_000, 300_000_000, 5.0  # an answer is awaited so long: datagrams are lost
_SPEED, _SLOWEST, _TURN = 0.5, 0.2, 0.5
_BRAKING_S = 0.8
_NEAR_M = 0.15  # of Nav2's goal checker
_END_M = 0.45  # the radius of the goal, the error of the pose, and the way while an answer is due
_SIMULATED = ("-p", "use_sim_time:=true")
_SMALLEST_M = 0.8
_IMAGE_TICKS = 10
_LOST = 0.05
_CAMERA = "front"


class _World:
    """The rover's model behind the bridge, the operator, and the stand-in for Nav2. All on the thread of the judge."""

    def __init__(self, judge: Judge, start: PlanarPose | None = None) -> None:
        self.model = RoverModel(seed=1, start=start)
        self.mode = "MODE_AUTO"
        self.goal: Any = None
        self.ends: list[PlanarPose] = []
        """True poses of the rover where it has reached its goals."""
        self.bridge: Bridge | None = None  # until then, the time stands still
        self._drives, self._commanded = False, 0  # and the time of the last command that has arrived
        self._moved = time.monotonic()
        node = judge.node
        self._clock = node.create_publisher(interface("rosgraph_msgs/msg/Clock"), "/clock", 10)
        self._velocity = node.create_publisher(interface("geometry_msgs/msg/Twist"), "/cmd_vel", 10)
        self._tf = node.create_publisher(interface("tf2_msgs/msg/TFMessage"), "/tf", 10)
        judge.on_thread(lambda: self._serve(node))

    def _serve(self, node: Any) -> None:
        self._server = ActionServer(
            node,
            NavigateToPose,
            "navigate_to_pose",
            lambda handle: None,
            handle_accepted_callback=lambda handle: setattr(self, "goal", handle),
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )
        self._timer = node.create_timer(_PERIOD_S, self._tick)

    @property
    def pose(self) -> PlanarPose | None:
        """Pose of the rover that Nav2 knows."""
        return self.model.pose

    @property
    def now(self) -> int:
        """Time of the simulation in nanoseconds."""
        return _BEGIN_NS + self.model.now

    @property
    def answered(self) -> int:
        """Time up to which the programs have answered what they were told."""
        return self._commanded if self._drives else self.now

    def tell(self, measured: list[Measurement]) -> None:
        """Tell the rover's programs what is measured."""
        self._tf.publish(transforms(self.model.pose, Time(nanoseconds=self.now).to_msg()))

    def close(self) -> None:
        """Stop the world, on the thread of the judge."""
        self._timer.cancel()
        self._server.destroy()

    def _tick(self) -> None:
        self._clock.publish(interface("rosgraph_msgs/msg/Clock")(clock=Time(nanoseconds=self.now).to_msg()))
        if self.bridge is None:
            return
        for envelope in self.bridge.arrived("hardware"):
            if envelope.WhichOneof("payload") == "drive_motor":
                message = envelope.drive_motor
                self.model.command(BoardCommand(message.distance_to_go, message.turning_radius))
                self._commanded = self.now
        if self.now - self.answered > _LATE_NS and time.monotonic() - self._moved < _PATIENCE_S:
            return
        self._moved = time.monotonic()
        measured = self.model.advance(_STEP_S)
        self.bridge.send(control_mode={"mode": self.mode})
        self.tell(measured)
        pose, drove = self.pose, self._drives
        self._drives = False
        if pose is None:
            self._drive(0.8 * _SPEED, _TURN)  # look around for landmarks
        elif self.goal is not None:
            self._steer(self.goal, pose)
        if self._drives and not drove:
            self._commanded = self.now

    def _steer(self, handle: Any, pose: PlanarPose) -> None:
        """Drive along the circle that leads from the rover to the goal, and slower near it."""
        place = handle.request.pose.pose.position
        ahead = pose.inverse() @ PlanarPose(place.x, place.y)
        distance = math.hypot(ahead.x, ahead.y)
        if handle.is_cancel_requested:
            self._finish(handle.canceled)
        elif distance < _NEAR_M:
            self.ends.append(self.model.pose)  # now: the next goal comes at once
            self._finish(handle.succeed)
        else:
            speed = max(_SLOWEST, min(_SPEED, distance / _BRAKING_S))
            curvature = 2 * ahead.y / distance**2 if ahead.x > 0 else math.copysign(1 / _SMALLEST_M, ahead.y)
            self._drive(speed, max(-_TURN, min(speed * curvature, _TURN)))

    def _drive(self, speed: float, turn: float) -> None:
        velocity = interface("geometry_msgs/msg/Twist")()
        velocity.linear.x, velocity.angular.z = speed, turn
        self._velocity.publish(velocity)
        self._drives = True

    def _finish(self, end: Callable[[], None]) -> None:
        handle, self.goal = self.goal, None
        handle.execute(lambda _: (end(), NavigateToPose.Result())[1])


class _MeasuredWorld(_World):
    """A world in which nobody knows the true pose: the boards and a camera measure, and datagrams are lost.

    Somebody has moved one of the four landmarks.
    """

    def __init__(self, judge: Judge) -> None:
        self._ticks, self._random = 0, random.Random(1)  # noqa: S311  # repeatable, not secret
        self._datagrams = RoverDatagrams(REGISTRY)
        self._tracker = SimulatedTracker(1, standing(field(), 1, {8: (0.7, -0.4)}))
        kind = interface("vision_msgs/msg/Detection3DArray")
        self._images = judge.node.create_publisher(kind, f"/{_CAMERA}/aruco/detections", 10)
        self._poses = judge.hear("/odometry/global", "nav_msgs/msg/Odometry")
        super().__init__(judge, PlanarPose(1.5, -1.0, math.pi / 2))

    @property
    def pose(self) -> PlanarPose | None:
        """Newest pose on the field that was estimated; None if it is old: the fusion has begun again without one."""
        if self._estimated is None:
            return None
        pose = self._poses.values[-1]["pose"]["pose"]
        place, turn = pose["position"], pose["orientation"]
        return PlanarPose(place["x"], place["y"], 2 * math.atan2(turn["z"], turn["w"]))

    @property
    def answered(self) -> int:
        """Time of the newest pose, too, while there is one."""
        return min(super().answered, self.now if self._estimated is None else self._estimated)

    @property
    def _estimated(self) -> int | None:
        stamp = self._poses.values[-1]["header"]["stamp"] if self._poses.values else {"sec": 0, "nanosec": 0}
        time = 10**9 * stamp["sec"] + stamp["nanosec"]
        return time if self.now - time < _OLD_NS else None

    def tell(self, measured: list[Measurement]) -> None:
        """Send the measurements of the boards, and publish what the camera sees."""
        self._ticks += 1
        for one in measured:
            if self.bridge and self._random.random() >= _LOST:
                self.bridge.send_datagram(self._datagrams.peer, self._datagrams.datagram(one)[1])
        if self._ticks % _IMAGE_TICKS == 0:
            seen = self._tracker.see(self.model.pose, self.now)
            self._images.publish(deserialize_message(cdr.encode(seen), self._images.msg_type))


def _opened(world: _World, judge: Judge, start: Start, held: ExitStack) -> None:
    """Start the bridge and `roverlink drive` between the world and the boards, and then its time."""
    bridge = Bridge(start, "rclpy", _SIMULATED, held)
    held.callback(judge.on_thread, world.close)  # before the sockets of the bridge
    drive = start("drive", "--middleware", "rclpy", "--ros-args", "-p", f"smallest_radius:={_SMALLEST_M}", *_SIMULATED)
    world.bridge = bridge
    drive.wait_for("control_mode is AUTO")


@pytest.fixture
def world(judge: Judge, start: Start) -> Iterator[_World]:
    """A world whose true poses are known."""
    with ExitStack() as held:
        _opened(world := _World(judge), judge, start, held)
        yield world


@pytest.fixture
def measured_world(judge: Judge, start: Start, tmp_path: Path, middleware: str) -> Iterator[_World]:
    """A world with odometry and fusion over a middleware, whose pose is known already."""
    landmarks, cameras = write_field(tmp_path, _CAMERA)
    files = ("--landmarks", landmarks, "--cameras", cameras)
    options = ("--middleware", middleware, "--ros-args", *_SIMULATED)
    with ExitStack() as held:
        world = _MeasuredWorld(judge)
        start("odometry", *options).wait_for("odometry on /odometry/wheel")
        start("fuse", *files, *options).wait_for("waiting for /odometry/wheel")
        _opened(world, judge, start, held)
        wait_until(lambda: world.pose is not None, "two landmarks that agree")
        yield world


def test_odometry_and_fusion_lead_the_rover_to_all_goals(measured_world: _World, start: Start, tmp_path: Path) -> None:
    """With slip, lost datagrams and a landmark that was moved, the rover ends at each of four goals.

    Odometry and fusion use either middleware.
    """
    goals, world = [(1.5, 1.5), (-1.5, 1.5), (-1.5, -1.5), (1.5, -1.5)], measured_world
    (tmp_path / "mission.yaml").write_text(json.dumps({"goals": [{"position": goal} for goal in goals]}))
    program = start("mission", "run", tmp_path / "mission.yaml", "--json", "--ros-args", *_SIMULATED)
    for number in range(1, len(goals) + 1):
        wait_until(lambda number=number: len(world.ends) >= number, f"goal {number}")
    assert program.end() == 0, str(program)
    for end, goal in zip(world.ends, goals):
        assert end.distance_to(PlanarPose(*goal)) < _END_M


def test_manual_over_the_link_stops_mission_and_rover(world: _World, start: Start, tmp_path: Path) -> None:
    """The goal is cancelled, and the rover stands, while it was driving."""
    (tmp_path / "mission.yaml").write_text("{goals: [{position: [30, 0]}]}")
    program = start("mission", "run", tmp_path / "mission.yaml", "--ros-args", *_SIMULATED)
    wait_until(lambda: world.model.speed > 0.3, "the rover on its way")
    world.mode, place = "MODE_MANUAL", world.model.pose.x
    assert program.end() == 1, str(program)
    assert "a person has taken over" in str(program)
    wait_until(lambda: world.model.speed == 0 and world.goal is None, "the rover that stands")
    assert world.model.pose.x - place < 2  # ten times what it takes
