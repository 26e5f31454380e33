"""Geometry of driving on a plane: poses, and the arcs that connect them.

Signs and axes are those of REP 103. The x axis of the rover points forward and its y axis to the left. Angles count
counterclockwise, seen from above, so a positive curvature or angular velocity turns to the left.

An arc has a curvature and not a radius, because the curvature of a straight line is an ordinary number, zero, and
because the curvature changes continuously from a left turn through straight to a right turn.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

FARTHEST_M = 2.01e7
"""Distance in metres that no two positions on Earth exceed. Sums and products of larger numbers may overflow."""


@dataclass(frozen=True, slots=True)
class PlanarPose:
    """Position and heading of a frame on a plane, in another frame on this plane.

    ``x`` and ``y`` are in metres. ``yaw`` is in radians; it may count whole turns.
    """

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0

    def __matmul__(self, other: PlanarPose) -> PlanarPose:
        """Return the pose, in the outer frame, of what has the pose ``other`` in this frame."""
        cosine, sine = math.cos(self.yaw), math.sin(self.yaw)
        return PlanarPose(
            self.x + cosine * other.x - sine * other.y, self.y + sine * other.x + cosine * other.y, self.yaw + other.yaw
        )

    def inverse(self) -> PlanarPose:
        """Return the pose of the outer frame in this frame."""
        cosine, sine = math.cos(self.yaw), math.sin(self.yaw)
        return PlanarPose(-cosine * self.x - sine * self.y, sine * self.x - cosine * self.y, -self.yaw)

    @property
    def is_on_earth(self) -> bool:
        """True if the pose has finite numbers, and a position that can be one on Earth."""
        return abs(self.x) <= FARTHEST_M and abs(self.y) <= FARTHEST_M and math.isfinite(self.yaw)

    def distance_to(self, other: PlanarPose) -> float:
        """Return the distance in metres between two positions."""
        return math.hypot(other.x - self.x, other.y - self.y)


@dataclass(frozen=True, slots=True)
class Arc:
    """Part of a circle that the origin of the rover's frame drives along, or of a straight line.

    ``length`` is in metres along the arc, negative for driving backwards. ``curvature`` is one over the radius, in 1/m:
    positive if the centre is to the left of the rover, zero for a straight line. A backward arc of positive curvature
    turns the rover clockwise: its centre is to the left, and the rover moves back around it.
    """

    length: float
    curvature: float

    @property
    def turn(self) -> float:
        """Change of the rover's yaw from the start to the end of the arc, in radians."""
        return self.length * self.curvature

    @property
    def end(self) -> PlanarPose:
        """Pose of the rover at the end of the arc, in its frame at the start.

        The chord of the arc has the direction ``turn / 2``.
        """
        half = self.turn / 2
        chord = self.length * _chord_of_unit(half)
        return PlanarPose(chord * math.cos(half), chord * math.sin(half), self.turn)

    def shortened(self, length: float) -> Arc:
        """Return the first ``length`` metres of the arc, with its direction; all of it if it is not longer."""
        return Arc(math.copysign(min(length, abs(self.length)), self.length), self.curvature)


def arc_of_twist(linear: float, angular: float, duration: float) -> Arc:
    """Return the arc that a rover drives with a constant velocity.

    ``linear`` is along x in m/s, ``angular`` about z in rad/s, ``duration`` in seconds. Raises `ValueError` for a turn
    on the spot, which is no arc of the rover's origin.
    """
    if linear == 0 and angular != 0:
        raise ValueError(f"a turn on the spot ({angular} rad/s at 0 m/s) is no arc")
    return Arc(linear * duration, angular / linear if linear else 0.0)


def arc_to(x: float, y: float) -> Arc:
    """Return the arc from the rover's origin, tangential to its x axis, through a point in its frame (in metres).

    The arc is the shorter way: backwards if the point is behind the rover. Raises `ValueError` for the origin itself.

    The circle through the origin and (x, y) with its centre on the y axis has the curvature 2 y / (x^2 + y^2), as in
    Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, 1992.
    """
    squared = x * x + y * y
    if squared == 0:
        raise ValueError("no arc leads from a point to itself")
    half = math.atan2(y, abs(x))
    return Arc(math.copysign(math.sqrt(squared), x) / _chord_of_unit(half), 2 * y / squared)


def _chord_of_unit(half: float) -> float:
    """Return the length of the chord of an arc of length 1, whose turn is two times ``half`` (in radians)."""
    return math.sin(half) / half if half else 1.0
