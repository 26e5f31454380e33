"""Following of a path by pure pursuit: the rover aims at a point of the path that is some distance ahead of it.

Source: Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, 1992. The rover follows the path forwards.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from roverkit.driving.arcs import PlanarPose, arc_to

Point = tuple[float, float]
"""Position x, y in metres in the frame of the path."""

_SAME_M = 1e-6  # far below what a rover can drive, and far above the rounding of positions in a field


class Ending(Enum):
    """State of the rover on its way along a path."""

    AHEAD = "ahead"
    REACHED = "reached"
    MISSED = "missed"
    """The end is behind the rover, or beside it inside of its smallest turn."""


@dataclass(frozen=True, slots=True)
class Steering:
    """Direction in which a rover follows a path."""

    ending: Ending
    curvature: float
    """Curvature of the arc to drive now, in 1/m."""
    left: float
    """Distance in metres to the end of the path."""


class PathFollower:
    """Way of a rover along one path. The rover never goes back to a part of the path that it has passed."""

    def __init__(self, points: Sequence[Point]) -> None:
        """Begin at the first point. Raises `ValueError` for no point, or for a position that cannot be one on Earth."""
        if not points:
            raise ValueError("the path is empty")
        if not all(PlanarPose(*point).is_on_earth for point in points):
            raise ValueError("the path has a position that is not a number, or not on Earth")
        self._points, self._lengths = [points[0]], [0.0]
        for point in points[1:]:
            length = self._lengths[-1] + math.dist(self._points[-1], point)
            if length > self._lengths[-1] + _SAME_M:  # otherwise the point repeats, and its direction means nothing
                self._points.append(point)
                self._lengths.append(length)
        self._passed = 0.0

    def steer(self, pose: PlanarPose, lookahead: float, smallest_radius: float, tolerance: float) -> Steering:
        """Return the direction for a rover at ``pose`` in the frame of the path; all distances are in metres.

        ``lookahead`` is the distance to the point at which the rover aims. The end is reached at a distance of at most
        ``tolerance``.
        """
        self._pass(pose, lookahead)
        end = self._relative(self._points[-1], pose)
        distance = math.hypot(*end)
        left = max(self._lengths[-1] - self._passed, distance)
        if distance <= tolerance and left - tolerance <= lookahead:
            return Steering(Ending.REACHED, 0.0, left)
        if self._passed == self._lengths[-1] and end[0] <= 0 and distance < max(lookahead, 2 * smallest_radius):
            return Steering(Ending.MISSED, 0.0, left)
        x, y = self._relative(self._point(self._passed + lookahead), pose)
        if x <= 0:  # turn around as tightly as possible: a circle through a point behind the rover is nearly straight
            return Steering(Ending.AHEAD, math.copysign(1 / max(smallest_radius, lookahead / 2), y), left)
        return Steering(Ending.AHEAD, arc_to(x, y).curvature, left)

    def _pass(self, pose: PlanarPose, lookahead: float) -> None:
        """Advance to the point of the path that is nearest to the rover.

        Only the next part of the path counts, because a path may cross itself.
        """
        if self._lengths[-1] == 0:
            return
        x, y = self._point(self._passed)
        nearest = math.hypot(x - pose.x, y - pose.y)
        until = self._passed + lookahead + 2 * nearest
        for index in range(self._segment(self._passed), self._segment(until) + 1):
            start, end = self._points[index : index + 2]
            before, after = self._lengths[index : index + 2]
            length = after - before
            along = ((pose.x - start[0]) * (end[0] - start[0]) + (pose.y - start[1]) * (end[1] - start[1])) / length
            passed = min(max(before + along, before, self._passed), after, until)
            x, y = self._point(passed)
            if (distance := math.hypot(x - pose.x, y - pose.y)) < nearest:
                nearest, self._passed = distance, passed

    def _point(self, passed: float) -> Point:
        """Return the point of the path at a distance in metres from its start.

        Beyond its end, the path continues straight on, so that the rover arrives in its direction.
        """
        if self._lengths[-1] == 0:
            return self._points[0]
        index = self._segment(passed)
        start, end = self._points[index : index + 2]
        before, after = self._lengths[index : index + 2]
        part = (passed - before) / (after - before)
        return start[0] + part * (end[0] - start[0]), start[1] + part * (end[1] - start[1])

    def _segment(self, passed: float) -> int:
        """Return the index of the segment at a distance in metres from the start; that of the last one at the end."""
        return min(bisect_right(self._lengths, passed), len(self._lengths) - 1) - 1

    def _relative(self, point: Point, pose: PlanarPose) -> Point:
        """Return a point of the path in the frame of the rover."""
        place = pose.inverse() @ PlanarPose(*point)
        return place.x, place.y
