"""Following of paths, with a rover that drives each arc exactly or slips, and the poses at which it stops."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from roverkit.driving.approach import LandmarkViewpoint, Waypoint
from roverkit.driving.arcs import Arc, PlanarPose
from roverkit.driving.board_commands import STOP, DrivingBoard
from roverkit.driving.drive_control import DriveControl, DriveSettings, Localization
from roverkit.driving.path_following import Ending, PathFollower, Point
from roverkit.simulation.rover_model import RoverModel, RoverSettings

_LOOKAHEAD, _RADIUS, _TOLERANCE, _STEP = 0.8, 0.5, 0.1, 0.04


def _follow(points: Sequence[Point], pose: PlanarPose) -> tuple[Ending, list[PlanarPose]]:
    """The end of the way, and the poses on it; a way that is far too long fails."""
    follower, poses = PathFollower(points), [pose]
    longest = 20 + 3 * sum(map(math.dist, points, points[1:])) + 3 * math.dist((pose.x, pose.y), points[0])
    while len(poses) * _STEP < longest:
        steering = follower.steer(poses[-1], _LOOKAHEAD, _RADIUS, _TOLERANCE)
        if steering.ending is not Ending.AHEAD:
            return steering.ending, poses
        curvature = min(max(steering.curvature, -1 / _RADIUS), 1 / _RADIUS)
        poses.append(poses[-1] @ Arc(_STEP, curvature).end)
    pytest.fail(f"the rover never arrives: {poses[-1]}")


def _beside(pose: PlanarPose, points: Sequence[Point]) -> float:
    """The distance of a pose to a path, in metres."""
    distances = []
    for (x, y), (to_x, to_y) in pairwise(points):
        along_x, along_y = to_x - x, to_y - y
        part = ((pose.x - x) * along_x + (pose.y - y) * along_y) / (along_x**2 + along_y**2)
        part = min(max(part, 0), 1)
        distances.append(math.hypot(x + part * along_x - pose.x, y + part * along_y - pose.y))
    return min(distances)


@st.composite
def _bends(draw: st.DrawFn) -> list[Point]:
    """A path with bends of at least 1.25 m radius after 3 m straight on, in points 20 cm apart."""
    pose, points = PlanarPose(3.0), [(0.2 * step, 0.0) for step in range(16)]
    for curvature, count in draw(st.lists(st.tuples(st.floats(-0.8, 0.8), st.integers(3, 12)), max_size=3)):
        for _ in range(count):
            pose = pose @ Arc(0.2, curvature).end
            points.append((pose.x, pose.y))
    return points


@pytest.mark.slow
@given(points=_bends(), aside=st.floats(-0.5, 0.5), yaw=st.floats(-0.7, 0.7))
def test_a_path_with_bends_is_followed_to_its_end(points: list[Point], aside: float, yaw: float) -> None:
    """Also from a start beside it. On its way the rover stays near, and does not take short cuts."""
    ending, poses = _follow(points, PlanarPose(0, aside, yaw))
    assert ending is Ending.REACHED
    assert math.dist((poses[-1].x, poses[-1].y), points[-1]) <= _TOLERANCE
    assert all(_beside(pose, points) < 0.15 + abs(aside) + 0.8 * abs(yaw) for pose in poses)


@pytest.mark.parametrize("far", [1e300, -1e160, 1e30, math.nan])
def test_a_position_that_is_not_on_earth_is_refused(far: float) -> None:
    """Its distances would overflow, and the rover would get a command that is no number."""
    with pytest.raises(ValueError, match="not on Earth"):
        PathFollower([(0.0, 0.0), (far, 1.0)])


def test_a_path_may_cross_itself_and_end_at_its_start() -> None:
    """The end does not count before the way to it is driven, and neither does a part that is near by chance."""
    eight = [(0.0, 0.0), (4.0, 4.0), (4.0, 0.0), (0.0, 4.0), (0.0, 0.0)]
    ending, poses = _follow(eight, PlanarPose(yaw=math.pi / 4))
    assert ending is Ending.REACHED
    for corner in eight:
        assert min(math.dist((pose.x, pose.y), corner) for pose in poses) < 0.5
    assert len(poses) * _STEP > 15


@pytest.mark.parametrize("goal", [(3.0, 1.0), (-5.0, 0.0), (0.0, -4.0), (-2.0, 2.0)])
def test_a_goal_is_a_path(goal: Point) -> None:
    """A point, also one that nearly repeats, is reached from anywhere, if it is not inside of the smallest turn."""
    beside = (goal[0], math.nextafter(goal[1], math.inf))
    for points in ([goal], [(0.0, 0.0), (0.0, 0.0), goal, goal], [(0.0, 0.0), goal, beside]):
        ending, poses = _follow(points, PlanarPose())
        assert ending is Ending.REACHED
        assert math.dist((poses[-1].x, poses[-1].y), goal) <= _TOLERANCE
    assert _follow([(0.1, 0.4)], PlanarPose())[0] is Ending.MISSED


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_a_rover_that_slips_follows_a_path(seed: int) -> None:
    """The poses are noisy and 100 ms late, and one command in twenty is lost."""
    board = DrivingBoard(smallest_radius=0.5, reverses=False)
    model = RoverModel(seed, RoverSettings(board=board, slip=0.05))
    settings = DriveSettings(board)
    control = DriveControl(lambda: settings, lambda _: None)
    rng = random.Random(seed)  # noqa: S311  # repeatable, not secret
    points = [(step / 10, math.sin(step / 10)) for step in range(100)]
    now, poses, speeds = 10**12, [model.pose] * 2, [0.0] * 2
    control.set_mode(True, now)
    control.follow(points, "map", now)
    for _ in range(1200):
        now += 50_000_000
        control.set_mode(True, now)
        pose = poses[-2] @ PlanarPose(rng.gauss(0, 0.03), rng.gauss(0, 0.03), rng.gauss(0, 0.02))
        control.localize(Localization(pose, "map", now - 100_000_000, 0.05, speeds[-2]), now)
        command = control.step(now)
        if command is not None and (command == STOP or rng.random() > 0.05):
            model.command(command)
        model.advance(0.05)
        poses.append(model.pose)
        speeds.append(model.velocity)
    assert control.status.reason.startswith("the end of the path is reached")
    assert math.dist((model.pose.x, model.pose.y), points[-1]) < 0.2
    assert max(_beside(pose, points) for pose in poses) < 0.3


# --- stops in front of landmarks and at positions -----------------------------------------------------------------

_metres = st.floats(-100, 100)
_angles = st.floats(-math.pi, math.pi)
_poses = st.builds(PlanarPose, _metres, _metres, _angles)
_distances = st.floats(0.1, 20)


@pytest.mark.slow
@given(_poses, _metres, _metres, st.one_of(st.none(), _angles), _distances, _angles)
def test_the_rover_looks_at_the_landmark_from_its_distance(
    start: PlanarPose, x: float, y: float, facing: float | None, distance: float, angle: float
) -> None:
    """From each pose, the landmark is straight ahead, as far as asked; an upright one is seen from its front."""
    view = LandmarkViewpoint("7", x, y, facing, distance)
    stop, viewpoint = view.stop_from(start), next(view.viewpoints(start, [angle]))
    for pose in (stop, viewpoint):
        seen = pose.inverse() @ PlanarPose(x, y)
        assert (seen.x, seen.y) == (pytest.approx(distance, abs=1e-9), pytest.approx(0, abs=1e-9))
    assert math.cos(viewpoint.yaw - stop.yaw - angle) == pytest.approx(1)
    if facing is not None:
        assert math.cos(math.atan2(stop.y - y, stop.x - x) - facing) == pytest.approx(1)


@pytest.mark.slow
@given(_poses, _distances, _angles, st.one_of(st.none(), _angles), _distances)
def test_without_a_heading_the_rover_stops_as_it_comes(
    start: PlanarPose, away: float, direction: float, yaw: float | None, distance: float
) -> None:
    """At a landmark on the ground, and at a position; at the place where it is, it keeps its own heading."""
    x, y = start.x + away * math.cos(direction), start.y + away * math.sin(direction)
    assert math.cos(LandmarkViewpoint("7", x, y, None, distance).stop_from(start).yaw - direction) == pytest.approx(1)
    stop = Waypoint(x, y, yaw).stop_from(start)
    assert (stop.x, stop.y) == (x, y)
    assert math.cos(stop.yaw - (direction if yaw is None else yaw)) == pytest.approx(1)
    assert Waypoint(start.x, start.y).stop_from(start) == start
