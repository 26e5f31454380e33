"""Coverage of a set of views: the parts of the image, the distances and the tilts of the board that the views show.

A view is the set of board corners found in one image.

Views of all parts of the image determine the distortion and the principal point. Views of a tilted board separate the
focal length from the distance. Views at several distances separate effects that look the same at one distance.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roverkit.calibration.views import View
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.poses.pose import Pose

CELLS = (6, 4)
"""Number of columns and rows of the grid that divides the image into regions."""
WANTED = 2
"""Number of views wanted for each region, distance and tilt."""
TILTED = math.radians(18)
"""Smallest angle in radians at which a board counts as tilted."""
NEAR, FAR = 0.6, 0.4
"""Bounds between near, middle and far: square root of the share of the image area that the board fills."""

DISTANCES = ("near", "middle", "far")
TILTS = ("left edge nearer", "right edge nearer", "top edge nearer", "bottom edge nearer")
"""Names of the tilts. Each names the edge of the board, as seen in the image, that is nearer to the camera."""


@dataclass(frozen=True, slots=True)
class Need:
    """Requirement for a good calibration: enough views show one part of the image, one distance, or one tilt."""

    kind: str
    """`region`, `distance` or `tilt`."""
    name: str
    """Region in words, such as `upper left`, or one of `DISTANCES` or `TILTS`."""
    have: int
    """Number of views so far that show this region, distance or tilt."""
    wanted: int = WANTED
    cell: tuple[int, int] | None = None
    """Column and row of a region in the grid of `CELLS`; None for a distance or a tilt."""

    @property
    def met(self) -> bool:
        """True if enough views meet the requirement."""
        return self.have >= self.wanted


@dataclass(frozen=True, slots=True)
class Traits:
    """Properties of one view that count for the coverage."""

    cells: frozenset[tuple[int, int]]
    """Regions that contain corners, each as (column, row) in the grid of `CELLS`."""
    distance: str
    """One of `DISTANCES`."""
    tilts: frozenset[str]
    """Tilts of the board, a subset of `TILTS`; empty if it faces the camera."""


class Coverage:
    """Counter of the views that show each region of the image, each distance and each tilt of the board."""

    def __init__(self) -> None:
        self._seen: Counter[tuple[int, int] | str] = Counter()

    @property
    def cells(self) -> NDArray[np.intp]:
        """Number of views that have corners in each region of the image, as an array (rows, columns)."""
        columns, rows = CELLS
        return np.array([[self._seen[column, row] for column in range(columns)] for row in range(rows)])

    def add(self, traits: Traits) -> None:
        """Count the properties of one more view."""
        self._seen.update((*traits.cells, traits.distance, *traits.tilts))

    def needs(self) -> tuple[Need, ...]:
        """Return all requirements, met or not: first the regions row by row, then the distances, then the tilts."""
        columns, rows = CELLS
        regions = (
            Need("region", region_name((column, row)), self._seen[column, row], cell=(column, row))
            for row in range(rows)
            for column in range(columns)
        )
        distances = (Need("distance", name, self._seen[name]) for name in DISTANCES)
        tilts = (Need("tilt", name, self._seen[name]) for name in TILTS)
        return (*regions, *distances, *tilts)

    def missing(self) -> tuple[Need, ...]:
        """Return the requirements that are not met yet."""
        return tuple(need for need in self.needs() if not need.met)

    def adds(self, traits: Traits) -> Iterator[Need]:
        """Yield the requirements that are not met yet and that a view with these properties would help to meet."""
        shown = {*traits.cells, traits.distance, *traits.tilts}
        for need in self.missing():
            if (need.cell or need.name) in shown:
                yield need


def region_name(cell: tuple[int, int]) -> str:
    """Return the name of a region of the image, such as `upper left` or `middle`. Several regions have the same name.

    `cell` is the column and row of the region.
    """
    (column, row), (columns, rows) = cell, CELLS
    across = ("left", "", "right")[column * 3 // columns]
    down = "upper" if row == 0 else "lower" if row == rows - 1 else ""
    return f"{down} {across}".strip() if across or down else "middle"


def traits(view: View, pose: Pose, outline: Floats) -> Traits:
    """Return the properties of a view that count for the coverage: image regions, distance and tilts of the board.

    `pose` is the board's pose (board to camera). `outline` (4, 2) holds the board's outer corners in pixels.
    """
    size = np.array(view.size)
    cells = np.clip(np.floor((view.corners + 0.5) / size * CELLS), 0, np.array(CELLS) - 1).astype(int)
    return Traits(frozenset(map(tuple, cells.tolist())), _distance(outline, view.size), frozenset(_tilts(pose)))


def _distance(outline: Floats, size: tuple[int, int]) -> str:
    x, y = outline.T
    area = abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2
    part = math.sqrt(area / (size[0] * size[1]))
    return DISTANCES[0] if part >= NEAR else DISTANCES[1] if part >= FAR else DISTANCES[2]


def _tilts(pose: Pose) -> Iterator[str]:
    """Yield up to two of `TILTS`; they follow from the direction of the board's normal in the camera's frame."""
    into = pose.rotation[:, 2]  # the normal points away from the camera, towards the nearer edge
    across, down = math.atan2(into[0], abs(into[2])), math.atan2(into[1], abs(into[2]))
    for angle, (negative, positive) in ((across, TILTS[:2]), (down, TILTS[2:])):
        if abs(angle) >= TILTED:
            yield positive if angle > 0 else negative
