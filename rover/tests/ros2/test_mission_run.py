"""`roverlink mission run` against action servers of a real rclpy, which stand in for Nav2."""

from __future__ import annotations

import json
import math
import signal
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from judge import Judge, interface  # skips this module where there is no rclpy
from needs import NO_OPENCV
from polling import wait_until
from programs import Program, Start
from rclpy.action import CancelResponse
from rclpy.qos import DurabilityPolicy, QoSProfile

pytest.importorskip("cv2", reason=NO_OPENCV)

from nav2_stand_in import ABORT, AUTO, HOLD, MANUAL, REACH, REFUSE, Goal, Nav2StandIn
from roverkit.driving.arcs import PlanarPose

_LANDMARKS = """
landmarks:
  7: {position: [6.0, 2.0, 0.8], rpy: [90, 0, -90]}
  8: {position: [0.0, -5.0, 0.0], rpy: [0, 0, 0]}
"""
Serve = Callable[..., Nav2StandIn]
_LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@pytest.fixture
def serve(judge: Judge) -> Iterator[Serve]:
    """Starts the stand-in for Nav2, which serves until the test is over."""
    with ExitStack() as held:

        def serve(outcome: Callable[[Goal, int], str] = lambda *_: REACH) -> Nav2StandIn:
            nav2 = Nav2StandIn(judge, outcome)
            held.callback(nav2.close)
            return nav2

        yield serve


@pytest.fixture
def run(start: Start, tmp_path: Path) -> Callable[..., Program]:
    """Starts a mission, given as the text of its file, in simulated time."""
    (tmp_path / "landmarks.yaml").write_text(_LANDMARKS)

    def run(mission: str, *options: str, simulated: str = "true") -> Program:
        file = tmp_path / "mission.yaml"
        file.write_text(mission)
        return start("mission", "run", file, "--json", *options, "--ros-args", "-p", f"use_sim_time:={simulated}")

    return run


def _told(program: Program) -> list[dict[str, Any]]:
    return [json.loads(line) for line in program.output]


def _states(program: Program) -> list[tuple[str, int]]:
    """States and goals that the program has reported, without those that tell only another distance."""
    return [(one["state"], one["goal"]) for one in _told(program) if one["distance"] is None]


def _near(pose: PlanarPose | None, x: float, y: float, yaw_degrees: float) -> bool:
    assert pose is not None
    turn = math.remainder(pose.yaw - math.radians(yaw_degrees), math.tau)
    return pose.distance_to(PlanarPose(x, y)) < 0.01 and abs(turn) < 1e-3


def test_all_kinds_of_goals_are_reached(serve: Serve, run: Callable[..., Program]) -> None:
    """Nothing is sent before the operator hands over; then Nav2 gets each goal on the map, and the state is latched."""
    nav2 = serve()
    nav2.mode, nav2.sees = MANUAL, lambda _: ["7", "8"]
    program = run("""
        landmarks: landmarks.yaml
        datum: {latitude: 50.0, longitude: 20.0, heading: 90}
        goals:
          - {position: [3.0, 4.0], heading: 90}
          - {position: [3.0, 8.0]}
          - {landmark: 7, distance: 2.0}
          - {landmark: 8}
          - {gps: [50.0001, 20.0]}
        """)
    program.wait_for('"waiting"', program.output)
    assert nav2.goals == []
    nav2.mode = AUTO
    assert program.end() == 0, str(program)
    poses = [goal.to for goal in nav2.goals]
    assert _near(poses[0], 3, 4, 90)
    assert _near(poses[1], 3, 8, 90), "the rover arrives as it comes"
    assert _near(poses[2], 4, 2, 0), "the landmark hangs, and faces against the x axis"
    toward = math.degrees(math.atan2(-7, -4))
    assert _near(poses[3], -math.cos(math.radians(toward)), -5 - math.sin(math.radians(toward)), toward), "it lies"
    assert poses[4] is not None
    assert (poses[4].x, poses[4].y) == (pytest.approx(11.12, abs=0.01), pytest.approx(0, abs=0.01)), "x is north"
    assert _states(program) == [
        ("waiting", 0),
        *((state, number) for number in range(1, 6) for state in ("driving", "reached")),
        ("done", 0),
    ]


def test_refused_and_failed_goals_are_tried_again(serve: Serve, run: Callable[..., Program]) -> None:
    """A refused goal is repeated; after a failed one the rover backs up; a goal that stays out of reach is left out.

    Without the rule `continue`, nothing is sent after a goal that failed.
    """
    outcomes = [REFUSE, REACH, ABORT, REACH, ABORT, REACH, ABORT, REACH, ABORT]
    nav2 = serve(lambda _, number: outcomes[number])
    nav2.pace = lambda: 0.1
    program = run("""
        retries: 2
        back_up: 0.4
        goals:
          - {position: [1, 0]}
          - {name: rock, position: [2, 0], on_failure: continue}
          - {position: [3, 0]}
          - {position: [4, 0], retries: 0}
          - {position: [5, 0]}
        """)
    assert program.end() == 1, str(program)
    assert [goal.back for goal in nav2.goals] == [None, None, None, 0.4, None, 0.4, None, None, None]
    assert [goal.to.x for goal in nav2.goals if goal.to] == [1, 1, 2, 2, 2, 3, 4]
    assert ("failed", 2) in _states(program)
    assert ("reached", 3) in _states(program)
    assert _states(program)[-1] == ("stopped", 4)
    assert "goal 2 (rock) is not reached: Nav2 could not reach it" in str(program)


def test_a_landmark_that_is_not_seen_is_searched(serve: Serve, run: Callable[..., Program]) -> None:
    """The rover backs up, then drives around the landmark's place; when it is seen, it drives to the goal again.

    If no camera sees a landmark, the search ends, and the report says which landmark.
    """
    nav2 = serve()
    nav2.sees = lambda pose: ["7"] if pose.y > 2.5 else []
    nav2.pace = lambda: 0.001 if nav2.pose and nav2.sees(nav2.pose) else 0.05  # time to look passes where it is in vain
    program = run("""
        landmarks: landmarks.yaml
        look: 1.0
        goals:
          - {landmark: 7, distance: 2, search: [30, -30]}
          - {landmark: 8, back_up: 0, search: [20]}
        """)
    assert program.end() == 1, str(program)
    assert [goal.back for goal in nav2.goals] == [None, 0.5, None, None, None, None, None]
    assert _near(nav2.goals[2].to, 6 - 2 * math.cos(math.pi / 6), 2 - 1, 30), "to its right"
    assert _near(nav2.goals[3].to, 6 - 2 * math.cos(math.pi / 6), 2 + 1, -30), "and to its left"
    assert _near(nav2.goals[4].to, 4, 2, 0), "and again to the goal"
    assert ("searching", 1) in _states(program)
    assert "no camera sees landmark 8" in str(program)


def test_manual_cancels_the_goal_at_once(judge: Judge, serve: Serve, run: Callable[..., Program]) -> None:
    """The goal is cancelled, nothing else is sent, and the mode AUTO afterwards does not resume the mission."""
    nav2 = serve(lambda *_: HOLD)
    state = judge.hear("/mission/state", "std_msgs/msg/String", _LATCHED)
    program = run("{goals: [{position: [1, 0]}, {position: [2, 0]}]}")
    nav2.wait_for_goals(1)
    wait_until(lambda: any(one["distance"] == 1.5 for one in _told(program)), "the distance that is left")
    nav2.mode = MANUAL
    wait_until(lambda: nav2.ends == ["canceled"], "the cancellation")
    nav2.mode = AUTO
    assert program.end() == 1, str(program)
    assert len(nav2.goals) == 1
    assert _states(program)[-1] == ("stopped", 1)
    assert "a person has taken over" in str(program)
    state.wait_for({"data": "stopped 1"})


def test_a_mode_that_changes_before_the_start_stops_nothing(
    judge: Judge, serve: Serve, run: Callable[..., Program]
) -> None:
    """Only a person who takes over after the rover was handed over ends the mission."""
    nav2 = serve()
    place, nav2.pose = nav2.pose, None
    program = run("{goals: [{position: [1, 0]}]}", "--wait", "60")
    wait_until(lambda: judge.node.count_subscribers("/control_mode"), "a program that hears the mode")
    for nav2.mode in (AUTO, MANUAL):
        heard = nav2.ticks
        wait_until(lambda: nav2.ticks > heard + 10, "the mode, several times")  # noqa: B023  # it is waited for here
    nav2.pose = place
    program.wait_for('"waiting"', program.output)
    nav2.mode = AUTO
    assert program.end() == 0, str(program)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_cancels_the_goal(
    judge: Judge, serve: Serve, run: Callable[..., Program], number: signal.Signals
) -> None:
    """Ctrl-C and SIGTERM leave no goal behind; the mission says that it is stopped, and has not done its work."""
    nav2 = serve(lambda *_: HOLD)
    state = judge.hear("/mission/state", "std_msgs/msg/String", _LATCHED)
    program = run("{goals: [{position: [1, 0]}]}")
    nav2.wait_for_goals(1)
    assert program.interrupt(number) == 130
    wait_until(lambda: nav2.ends == ["canceled"], "the cancellation")
    assert _states(program)[-1] == ("stopped", 1)
    state.wait_for({"data": "stopped 1"})


def test_goals_and_poses_have_their_time(serve: Serve, run: Callable[..., Program]) -> None:
    """After its time a goal is cancelled, and tried again. A rover without a pose before a goal has lost its way."""

    def outcome(goal: Goal, number: int) -> str:
        if number == 1:
            nav2.pose = None
        return (HOLD, ABORT)[number]

    nav2 = serve(outcome)
    nav2.pace = lambda: 0.5 if nav2.goals else 0.001
    program = run("{timeout: 20, back_up: 0, goals: [{position: [1, 0]}]}")
    assert program.end() == 1, str(program)
    assert nav2.ends == ["canceled", "abort"]
    assert "it took too long; trying again (1)" in str(program)
    assert "the rover has lost its position" in str(program)


def test_a_goal_of_a_nav2_that_disappears_has_failed(serve: Serve, run: Callable[..., Program]) -> None:
    """The program does not wait for the time of the goal to pass, nor for long until a server is there again."""
    nav2 = serve(lambda *_: HOLD)
    program = run("{retries: 1, goals: [{position: [1, 0]}]}")
    nav2.wait_for_goals(1)
    nav2.close()
    program.wait_for("Nav2 is dead: its server has disappeared, or has said nothing for 5 s; trying again (1)")
    nav2.pace = lambda: 0.5
    assert program.end() == 1, str(program)
    assert "is not reached: Nav2 is dead" in str(program)


def test_a_nav2_that_is_silent_is_dead(serve: Serve, run: Callable[..., Program]) -> None:
    """DDS knows a killed server for some time."""
    nav2 = serve(lambda *_: HOLD)
    program = run("{retries: 0, goals: [{position: [1, 0]}]}")
    wait_until(lambda: any(one["distance"] == 1.5 for one in _told(program)), "the distance that is left")
    nav2.is_frozen = True
    assert program.end() == 1, str(program)
    assert "is not reached: Nav2 is dead" in str(program)


def test_a_refused_cancellation_is_said(serve: Serve, run: Callable[..., Program]) -> None:
    """A rover whose goal goes on may drive on."""
    nav2 = serve(lambda *_: HOLD)
    nav2.cancels = CancelResponse.REJECT
    program = run("{goals: [{position: [1, 0]}]}")
    nav2.wait_for_goals(1)
    nav2.mode = MANUAL
    program.wait_for("Nav2 refused to cancel the goal")
    assert program.end() == 1, str(program)


def test_another_program_may_end_the_mission(judge: Judge, serve: Serve, run: Callable[..., Program]) -> None:
    """A goal that somebody else has cancelled, such as RViz, is not sent again."""
    nav2 = serve(lambda *_: HOLD)
    program = run("{goals: [{position: [1, 0]}]}")
    nav2.wait_for_goals(1)
    every_goal = interface("action_msgs/srv/CancelGoal").Request()
    judge.call("/navigate_to_pose/_action/cancel_goal", "action_msgs/srv/CancelGoal", every_goal)
    assert program.end() == 1, str(program)
    assert len(nav2.goals) == 1
    assert "another program has cancelled the goal" in str(program)


def test_a_goal_waits_until_answers_arrive(serve: Serve, run: Callable[..., Program]) -> None:
    """A server that is found, but whose answers go to nobody yet, gets no goal: its answer would be lost for good."""
    nav2 = serve()
    for server in nav2.servers:
        server.unheard = 3
    program = run("{goals: [{position: [1, 0]}]}")
    assert program.end() == 0, str(program)
    assert nav2.ends == ["succeed"]
    assert "trying again" not in str(program)


def test_without_nav2_or_a_pose_the_program_says_so(serve: Serve, run: Callable[..., Program]) -> None:
    """Exit code 2, and one line with the cure."""
    program = run("{goals: [{position: [1, 0]}]}", "--wait", "0.5", simulated="false")
    assert program.end() == 2
    assert "Nav2 is not there: no server of the action /navigate_to_pose" in program.errors[-1]
    nav2 = serve()
    nav2.pose = None
    navigate, _ = nav2.servers
    nav2.pace = lambda: 0.5 if navigate.asked else 0.001
    program = run("{goals: [{position: [1, 0]}]}", "--wait", "100")
    assert program.end() == 2
    assert "the rover's pose on the map is not known" in program.errors[-1]
