"""A stand-in for Nav2, the rover and the operator: action servers of a real rclpy, whose goals end as the test says.

The rover is where the last goal that was reached has left it. Everything happens on the thread of the judge.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest
from judge import Judge, interface  # skips the module of the test where there is no rclpy
from polling import wait_until

pytest.importorskip("nav2_msgs")

from nav2_msgs.action import BackUp, NavigateToPose
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.duration import Duration
from rclpy.time import Time
from roverkit.driving.arcs import PlanarPose

from generated.messages import BasestationControlMode

REACH, REFUSE, ABORT, HOLD = "reach", "refuse", "abort", "hold"
"""What becomes of a goal; one that is held goes on until somebody cancels it."""
AUTO, MANUAL = BasestationControlMode.MODE_AUTO, BasestationControlMode.MODE_MANUAL
_PERIOD_S = 0.02
_TICKS = 10  # from the arrival to its report: by then, no pose from before passes for the present one


@dataclass(frozen=True)
class Goal:
    """A goal that has come: the pose to drive to, or the distance to back up."""

    to: PlanarPose | None = None
    back: float | None = None


def transforms(pose: PlanarPose, stamp: Any) -> Any:
    """Make the message on /tf that says where the rover is at a time."""
    one = interface("geometry_msgs/msg/TransformStamped")()
    one.header.stamp = stamp
    one.header.frame_id, one.child_frame_id = "map", "base_link"
    one.transform.translation.x, one.transform.translation.y = pose.x, pose.y
    one.transform.rotation.z, one.transform.rotation.w = math.sin(pose.yaw / 2), math.cos(pose.yaw / 2)
    return interface("tf2_msgs/msg/TFMessage")(transforms=[one])


class _Server(ActionServer):
    """A server whose answers go to nobody until some requests have come, as those of Fast DDS may do at first."""

    unheard = 0
    """Number of requests that it still takes without an answer."""
    asked = 0
    """Number of requests that have come."""

    async def execute(self, taken_data: Any) -> None:
        """Execute what has come, except for the first requests."""
        self.asked += 1
        if self.asked > self.unheard:
            await super().execute(taken_data)


@dataclass
class _Running:
    """A goal that was accepted."""

    handle: Any
    number: int
    ticks: int = 0


class Nav2StandIn:
    """Action servers NavigateToPose and BackUp, the rover's pose on /tf, landmarks in sight, the mode, and the time."""

    def __init__(self, judge: Judge, outcome: Callable[[Goal, int], str]) -> None:
        """Serve; ``outcome`` says what becomes of a goal, by its number from 0."""
        self.goals: list[Goal] = []
        """All goals that have come, refused ones too."""
        self.ends: list[str] = []
        """Ends of the goals that were accepted: reached, aborted or canceled."""
        self.pose: PlanarPose | None = PlanarPose()
        self.sees: Callable[[PlanarPose], list[str]] = lambda _: []
        self.mode: int | None = AUTO
        """Mode that the operator repeats; None for silence."""
        self.ticks = 0
        """Number of times that the stand-in has told the mode and the pose."""
        self.time = Time(seconds=1000)
        """Simulated time."""
        self.pace: Callable[[], float] = lambda: 0.001
        """Simulated seconds that pass from one tick to the next."""
        self.cancels = CancelResponse.ACCEPT
        self.is_frozen = False
        """True while the goals get neither feedback nor an end, as those of a killed server that DDS still knows."""
        self._outcome = outcome
        self._running: list[_Running] = []
        self._judge = judge
        judge.on_thread(lambda: self._serve(judge.node))

    def _serve(self, node: Any) -> None:
        self.servers = [
            _Server(
                node,
                kind,
                name,
                lambda handle: None,
                goal_callback=self._answer,
                handle_accepted_callback=lambda handle: self._running.append(_Running(handle, len(self.goals) - 1)),
                cancel_callback=lambda _: self.cancels,
            )
            for kind, name in ((NavigateToPose, "navigate_to_pose"), (BackUp, "backup"))
        ]
        self._publish = {
            topic: node.create_publisher(interface(kind), topic, 10).publish
            for topic, kind in {
                "/clock": "rosgraph_msgs/msg/Clock",
                "/tf": "tf2_msgs/msg/TFMessage",
                "/aruco/detections": "vision_msgs/msg/Detection3DArray",
                "/control_mode": "comms/msg/BasestationControlMode",
            }.items()
        }
        node.create_timer(_PERIOD_S, self._tick)

    def wait_for_goals(self, count: int) -> None:
        """Wait until a number of goals have come."""
        wait_until(lambda: len(self.goals) >= count, f"{count} goals; there are {self.goals}")

    def close(self) -> None:
        """Stop serving, so that no later test finds these servers."""
        self._judge.on_thread(lambda: [server.destroy() for server in self.servers])
        self.servers, self._running = [], []

    def _answer(self, request: Any) -> GoalResponse:
        if hasattr(request, "target"):
            goal = Goal(back=request.target.x)
        else:
            place, turn = request.pose.pose.position, request.pose.pose.orientation
            goal = Goal(PlanarPose(place.x, place.y, 2 * math.atan2(turn.z, turn.w)))
        self.goals.append(goal)
        refused = self._outcome(goal, len(self.goals) - 1) == REFUSE
        return GoalResponse.REJECT if refused else GoalResponse.ACCEPT

    def _tick(self) -> None:
        self.ticks += 1
        self.time += Duration(seconds=self.pace())
        self._tell_world()
        for one in () if self.is_frozen else [*self._running]:
            goal, outcome = self.goals[one.number], self._outcome(self.goals[one.number], one.number)
            one.ticks += 1
            if one.handle.is_cancel_requested:
                self._finish(one, "canceled")
            elif outcome == HOLD:
                if goal.to is not None:
                    one.handle.publish_feedback(NavigateToPose.Feedback(distance_remaining=1.5))
            elif one.ticks == 1 and outcome == REACH:
                self.pose = goal.to or (self.pose or PlanarPose()) @ PlanarPose(-(goal.back or 0.0))
            elif one.ticks > _TICKS:
                self._finish(one, "succeed" if outcome == REACH else "abort")

    def _finish(self, one: _Running, how: str) -> None:
        self._running.remove(one)
        kind = NavigateToPose if self.goals[one.number].to else BackUp

        def execute(accepted: Any) -> Any:
            getattr(accepted, how)()
            self.ends.append(how)
            return kind.Result()

        one.handle.execute(execute)

    def _tell_world(self) -> None:
        """Say where the rover is, which landmarks its camera sees, and who drives."""
        self._publish["/clock"](interface("rosgraph_msgs/msg/Clock")(clock=self.time.to_msg()))
        if self.mode is not None:
            self._publish["/control_mode"](interface("comms/msg/BasestationControlMode")(mode=self.mode))
        if self.pose is None:
            return
        self._publish["/tf"](transforms(self.pose, self.time.to_msg()))
        seen = [interface("vision_msgs/msg/Detection3D")(id=name) for name in self.sees(self.pose)]
        self._publish["/aruco/detections"](interface("vision_msgs/msg/Detection3DArray")(detections=seen))
