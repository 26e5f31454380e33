"""Poses at which the rover stops, in front of landmarks and at positions."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roverlink.driving.approach import LandmarkView, Waypoint
from roverlink.driving.arcs import PlanarPose

_metres = st.floats(-100, 100)
_angles = st.floats(-math.pi, math.pi)
_poses = st.builds(PlanarPose, _metres, _metres, _angles)
_distances = st.floats(0.1, 20)


@given(_poses, _metres, _metres, st.one_of(st.none(), _angles), _distances, st.lists(_angles, max_size=4))
def test_the_rover_looks_at_the_landmark_from_its_distance(
    start: PlanarPose, x: float, y: float, facing: float | None, distance: float, angles: list[float]
) -> None:
    """From each pose, the landmark is straight ahead, as far away as asked."""
    view = LandmarkView("7", x, y, facing, distance)
    for pose in (view.stop_from(start), *view.viewpoints(start, angles)):
        seen = pose.inverse() @ PlanarPose(x, y)
        assert (seen.x, seen.y) == (pytest.approx(distance, abs=1e-9), pytest.approx(0, abs=1e-9))


@given(_poses, _metres, _metres, _angles, _distances, _angles)
def test_the_rover_stops_where_the_landmark_faces(
    start: PlanarPose, x: float, y: float, facing: float, distance: float, angle: float
) -> None:
    """An upright landmark is seen from its front, wherever the rover comes from; viewpoints are beside it."""
    view = LandmarkView("7", x, y, facing, distance)
    stop, viewpoint = view.stop_from(start), next(view.viewpoints(start, [angle]))
    assert math.cos(math.atan2(stop.y - y, stop.x - x) - facing) == pytest.approx(1)
    assert math.cos(viewpoint.yaw - stop.yaw - angle) == pytest.approx(1)


@given(_poses, _distances, _angles, _distances)
def test_a_landmark_on_the_ground_is_seen_from_where_the_rover_comes(
    start: PlanarPose, away: float, direction: float, distance: float
) -> None:
    """The stop is on the straight line from the rover to the landmark."""
    x, y = start.x + away * math.cos(direction), start.y + away * math.sin(direction)
    stop = LandmarkView("7", x, y, None, distance).stop_from(start)
    assert math.cos(stop.yaw - direction) == pytest.approx(1)


@given(_poses, st.one_of(st.none(), _angles), _distances, _angles)
def test_a_position_has_its_heading_or_that_of_the_arrival(
    start: PlanarPose, yaw: float | None, away: float, direction: float
) -> None:
    """Without a heading, the rover stops as it comes; at the place where it is, it keeps its own heading."""
    place = Waypoint(start.x + away * math.cos(direction), start.y + away * math.sin(direction), yaw)
    stop = place.stop_from(start)
    assert (stop.x, stop.y) == (place.x, place.y)
    assert math.cos(stop.yaw - (direction if yaw is None else yaw)) == pytest.approx(1)
    assert Waypoint(start.x, start.y).stop_from(start) == start
