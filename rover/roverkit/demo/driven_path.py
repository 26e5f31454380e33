"""True and estimated paths of the demo's rover, for the map on the page of the demo."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping
from typing import Any

_POINTS = 600
"""Points of each path that are kept: about half a minute of the odometry."""
Point = tuple[float, float]
"""Position x, y on the field in metres."""


class EstimatedPath:
    """Newest part of an estimated path, with its errors."""

    def __init__(self) -> None:
        self.points: deque[Point] = deque(maxlen=_POINTS)
        self.error: float | None = None
        """Distance in metres of the newest position from the true one; None before the first one."""

    def add(self, estimated: Point, true: Point) -> None:
        """Add a position, and the true one at the same time."""
        self.points.append(estimated)
        self.error = math.dist(estimated, true)


class DrivenPath:
    """Newest parts of all paths. Points may be added on some threads and read on others."""

    def __init__(self) -> None:
        self.landmarks: Mapping[str, Point] = {}
        """Places of the landmarks by their names."""
        self.true: deque[Point] = deque(maxlen=_POINTS)
        self.odometry, self.camera = EstimatedPath(), EstimatedPath()

    def as_dict(self) -> dict[str, Any]:
        """Return landmarks, paths and errors as JSON values, oldest point first."""
        return {
            "landmarks": [{"name": name, "place": place} for name, place in self.landmarks.items()],
            "true": _rounded(self.true),
            "odometry": _rounded(self.odometry.points),
            "estimated": _rounded(self.camera.points),
            "errors": {"odometry": self.odometry.error, "estimated": self.camera.error},
        }


def _rounded(points: deque[Point]) -> list[Point]:
    # The copy is made in one step, so that no other thread adds a point meanwhile.
    return [(round(x, 3), round(y, 3)) for x, y in points.copy()]
