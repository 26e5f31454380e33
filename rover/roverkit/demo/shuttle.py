"""Way of the demo's rover: to and fro before the landmarks, so that its camera always sees some of them.

The rover drives forwards on a curve, back on a straight line, forwards on the opposite curve, and back again. It is
steered by its true pose, as by a person who watches it, so that slip does not carry it away.
"""

from __future__ import annotations

import itertools
import math

from roverkit.driving.arcs import Arc, PlanarPose
from roverkit.driving.board_commands import BoardCommand, DrivingBoard
from roverkit.driving.path_following import Ending, PathFollower, Point, Steering

_FAR, _NEAR, _SIDE = -1.2, 1.0, 0.25
"""Largest and smallest distance from the landmarks, and to the sides, as coordinates on the field in metres."""
_CORNERS = ((_FAR, -_SIDE), (_NEAR, _SIDE), (_FAR, _SIDE), (_NEAR, -_SIDE), (_FAR, -_SIDE))
_POINTS = 24
"""Points of the path between two corners."""
_LOOKAHEAD_M = 0.5
_TOLERANCE_M = 0.05
_STEP_M = 0.25
"""Longest distance of a command; the next command comes before the rover has driven it."""
_SMALLEST_RADIUS_M = 1.0
_BACKWARDS = PlanarPose(0.0, 0.0, math.pi)

START = PlanarPose(_FAR, -_SIDE)
"""Pose of the rover at the start."""


class Shuttle:
    """Driver of the rover; every second part of the way is driven backwards."""

    def __init__(self) -> None:
        self._parts = itertools.cycle(itertools.pairwise(_CORNERS))
        self._board = DrivingBoard(smallest_radius=_SMALLEST_RADIUS_M)
        self._forwards = False
        self._next_part()

    def command(self, pose: PlanarPose) -> BoardCommand:
        """Return the command for the rover at a pose: an arc to the path ahead."""
        steering = self._steer(pose)
        if steering.ending is not Ending.AHEAD:
            self._next_part()
            steering = self._steer(pose)
        # On the same circle, the rover turns to its left forwards, and to its right backwards.
        sign = 1 if self._forwards else -1
        return self._board.command(Arc(sign * min(steering.left, _STEP_M), sign * steering.curvature))

    def _steer(self, pose: PlanarPose) -> Steering:
        # A rover that drives backwards follows the path like one that looks in the opposite direction.
        ahead = pose if self._forwards else pose @ _BACKWARDS
        return self._follower.steer(ahead, _LOOKAHEAD_M, _SMALLEST_RADIUS_M, _TOLERANCE_M)

    def _next_part(self) -> None:
        self._follower = PathFollower(_between(*next(self._parts)))
        self._forwards = not self._forwards


def _between(start: Point, end: Point) -> list[Point]:
    """Return the points of a path that begins and ends in the direction of the x axis."""
    points = []
    for index in range(_POINTS + 1):
        along = index / _POINTS
        aside = (1 - math.cos(math.pi * along)) / 2
        points.append((start[0] + along * (end[0] - start[0]), start[1] + aside * (end[1] - start[1])))
    return points
