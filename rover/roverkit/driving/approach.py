"""Poses at which the rover stops: at a position, or in front of a landmark that its camera should see.

Positions and headings are those of a map, in metres and radians, counterclockwise (REP 103). The camera looks ahead.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from roverkit.driving.arcs import PlanarPose

_SAME_M = 1e-3  # nearer than this, two positions have no direction from one to the other


@dataclass(frozen=True, slots=True)
class Waypoint:
    """Position to stop at, with a heading, or with None for the heading in which the rover arrives."""

    x: float
    y: float
    yaw: float | None = None

    def stop_from(self, start: PlanarPose) -> PlanarPose:
        """Return the pose in which the rover stops, if it comes from ``start``."""
        yaw = _direction(start, self.x, self.y) if self.yaw is None else self.yaw
        return PlanarPose(self.x, self.y, start.yaw if yaw is None else yaw)


@dataclass(frozen=True, slots=True)
class LandmarkViewpoint:
    """Place in front of a landmark, from which the camera sees it.

    ``landmark`` is its number or name, ``x`` and ``y`` its position. ``facing`` is the direction in which an upright
    landmark looks. It is None for one that lies on the ground, which can be seen from all sides. ``distance`` is that
    of the rover from the landmark.
    """

    landmark: str
    x: float
    y: float
    facing: float | None
    distance: float

    def stop_from(self, start: PlanarPose) -> PlanarPose:
        """Return the pose in which the rover stops, if it comes from ``start``."""
        return self._view(self._side(start))

    def viewpoints(self, start: PlanarPose, angles: Sequence[float]) -> Iterator[PlanarPose]:
        """Yield poses from which to search the landmark: beside the stop by angles in radians around the landmark."""
        side = self._side(start)
        return (self._view(side + angle) for angle in angles)

    def _side(self, start: PlanarPose) -> float:
        """Return the direction from the landmark to the rover's stop."""
        if self.facing is not None:
            return self.facing
        ahead = _direction(start, self.x, self.y)
        return (start.yaw if ahead is None else ahead) + math.pi

    def _view(self, side: float) -> PlanarPose:
        x, y = self.x + self.distance * math.cos(side), self.y + self.distance * math.sin(side)
        return PlanarPose(x, y, math.remainder(side + math.pi, math.tau))


def _direction(start: PlanarPose, x: float, y: float) -> float | None:
    """Return the direction from a pose to a position; None if the pose is there."""
    east, north = x - start.x, y - start.y
    return math.atan2(north, east) if math.hypot(east, north) > _SAME_M else None
