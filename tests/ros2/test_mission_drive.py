"""A mission with all programs on its way to the boards, and a simulated rover at the end of them.

`roverlink mission run` sends goals to an action server that stands in for Nav2: it steers towards the goal. `roverlink
drive` makes commands of its velocities, and the bridge sends them to the driving board, which is a model whose wheels
slip. The operator's mode comes over the link, too.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from judge import Bridge, Judge, interface  # skips this module where there is no rclpy
from needs import NO_OPENCV
from polling import wait_until
from programs import Start

pytest.importorskip("cv2", reason=NO_OPENCV)

from nav2_stand_in import transforms  # skips this module where nav2_msgs is missing

# isort: split

from nav2_msgs.action import NavigateToPose
from rclpy.action import ActionServer, CancelResponse

from roverlink.driving.arcs import PlanarPose
from roverlink.driving.board_commands import BoardCommand
from roverlink.driving.rover_model import RoverModel

_PERIOD_S = 0.02
_SPEED, _TURN = 0.5, 0.5
_NEAR_M = 0.25  # of Nav2's goal checker


class _World:
    """The rover's model behind the bridge, the operator, and the stand-in for Nav2. All on the thread of the judge."""

    def __init__(self, judge: Judge, bridge: Bridge) -> None:
        self.model = RoverModel(seed=1)
        self.mode = "MODE_AUTO"
        self.goal: Any = None
        self._bridge, self._clock = bridge, judge.node.get_clock()
        self._velocity = judge.node.create_publisher(interface("geometry_msgs/msg/Twist"), "/cmd_vel", 10)
        self._tf = judge.node.create_publisher(interface("tf2_msgs/msg/TFMessage"), "/tf", 10)
        self._server = ActionServer(
            judge.node,
            NavigateToPose,
            "navigate_to_pose",
            lambda handle: None,
            handle_accepted_callback=lambda handle: setattr(self, "goal", handle),
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )
        self._timer = judge.node.create_timer(_PERIOD_S, self._tick)

    def close(self) -> None:
        """Stop the world, on the thread of the judge."""
        self._timer.cancel()
        self._server.destroy()

    def _tick(self) -> None:
        self._bridge.send(control_mode={"mode": self.mode})
        for envelope in self._bridge.arrived("hardware"):
            if envelope.WhichOneof("payload") == "drive_motor":
                message = envelope.drive_motor
                self.model.command(BoardCommand(message.distance_to_go, message.turning_radius))
        self.model.advance(_PERIOD_S)
        self._tf.publish(transforms(self.model.pose, self._clock))
        if self.goal is not None:
            self._steer(self.goal)

    def _steer(self, handle: Any) -> None:
        """Drive along the circle that leads from the rover to the goal."""
        place = handle.request.pose.pose.position
        ahead = self.model.pose.inverse() @ PlanarPose(place.x, place.y)
        if handle.is_cancel_requested:
            self._finish(handle.canceled)
        elif math.hypot(ahead.x, ahead.y) < _NEAR_M:
            self._finish(handle.succeed)
        else:
            velocity = interface("geometry_msgs/msg/Twist")()
            turn = _SPEED * 2 * ahead.y / (ahead.x**2 + ahead.y**2)
            velocity.linear.x, velocity.angular.z = _SPEED, max(-_TURN, min(turn, _TURN))
            self._velocity.publish(velocity)

    def _finish(self, end: Callable[[], None]) -> None:
        handle, self.goal = self.goal, None
        handle.execute(lambda _: (end(), NavigateToPose.Result())[1])


@pytest.fixture
def world(judge: Judge, start: Start) -> Iterator[_World]:
    """The bridge, `roverlink drive`, and the world at both ends of them."""
    with ExitStack() as held:
        world = _World(judge, Bridge(start, "rclpy", (), held))
        drive = start("drive", "--middleware", "rclpy", "--ros-args", "-p", "smallest_radius:=0.8")
        drive.wait_for("control_mode is AUTO")
        yield world
        wait_until(judge.executor.create_task(world.close).done, "the end of the world")


def test_the_rover_drives_to_all_goals(world: _World, start: Start, tmp_path: Path) -> None:
    """In spite of slip, the model is within the tolerance of each goal when the mission says so."""
    goals = [(1.5, 0.0), (3.0, 1.5), (1.5, 3.0)]
    (tmp_path / "mission.yaml").write_text(json.dumps({"goals": [{"position": goal} for goal in goals]}))
    program = start("mission", "run", tmp_path / "mission.yaml", "--json")
    for number, goal in enumerate(goals, 1):
        program.wait_for(f'"reached", "goal": {number}', program.output)
        assert world.model.pose.distance_to(PlanarPose(*goal)) < _NEAR_M + 0.2, "it may have rolled on"
    assert program.end() == 0, str(program)


def test_manual_over_the_link_stops_mission_and_rover(world: _World, start: Start, tmp_path: Path) -> None:
    """The goal is cancelled, and the rover stands, while it was driving."""
    (tmp_path / "mission.yaml").write_text("{goals: [{position: [30, 0]}]}")
    program = start("mission", "run", tmp_path / "mission.yaml")
    wait_until(lambda: world.model.speed > 0.3, "the rover on its way")
    world.mode, place = "MODE_MANUAL", world.model.pose.x
    assert program.end() == 1, str(program)
    assert "a person has taken over" in str(program)
    wait_until(lambda: world.model.speed == 0 and world.goal is None, "the rover that stands")
    assert world.model.pose.x - place < 1
