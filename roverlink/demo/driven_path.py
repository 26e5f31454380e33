"""True and estimated path of the demo's rover, for the map on the page of the demo."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Any

_POINTS = 300
"""Points of each path that are kept."""
Point = tuple[float, float]
"""Position x, y on the field in metres."""


class DrivenPath:
    """Newest parts of both paths. Points may be added on one thread and read on others."""

    def __init__(self, landmarks: Mapping[str, Point]) -> None:
        """Begin without a point; ``landmarks`` has the places of the landmarks by their names."""
        self._landmarks = landmarks
        self._points: deque[tuple[Point, Point]] = deque(maxlen=_POINTS)

    def add(self, true: Point, estimated: Point) -> None:
        """Add a position of the rover, and the one that was estimated for the same time."""
        self._points.append((true, estimated))

    def as_dict(self) -> dict[str, Any]:
        """Return landmarks and paths as JSON values, oldest point first."""
        points = list(self._points)  # one step, so that no other thread adds a point meanwhile
        return {
            "landmarks": [{"name": name, "place": place} for name, place in self._landmarks.items()],
            "true": [true for true, _ in points],
            "estimated": [estimated for _, estimated in points],
        }
