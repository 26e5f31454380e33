"""What a set of views covers: which parts of the image, which distances, and which tilts of the board.

Parts of the image are needed for the distortion and the principal point, tilts to tell the focal length from the
distance, and distances to tell apart what both have in common.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roverlink.vision.calibration.views import View
from roverlink.vision.camera.camera_model import Floats
from roverlink.vision.poses.pose import Pose

CELLS = (6, 4)
"""Columns and rows of the parts of the image."""
WANTED = 2
"""Views that see a part of the image, and that are at each distance and tilt."""
TILTED = math.radians(18)
"""From where on a board counts as tilted."""
NEAR, FAR = 0.6, 0.4
"""The side of a square of the board's area in the image, in parts of that of the image's."""

DISTANCES = ("near", "middle", "far")
TILTS = ("left edge nearer", "right edge nearer", "top edge nearer", "bottom edge nearer")
"""Edges as they are in the image."""


@dataclass(frozen=True, slots=True)
class Need:
    """Something that a calibration needs views of."""

    kind: str
    """`region`, `distance` or `tilt`."""
    name: str
    """Of a region the words for where it is; else one of `DISTANCES` or `TILTS`."""
    have: int
    """Views so far."""
    wanted: int = WANTED
    cell: tuple[int, int] | None = None
    """A region's column and row in the grid of `CELLS`."""

    @property
    def met(self) -> bool:
        """Whether there are enough."""
        return self.have >= self.wanted


@dataclass(frozen=True, slots=True)
class Traits:
    """What one view shows."""

    cells: frozenset[tuple[int, int]]
    """Column and row of each part of the image that has corners."""
    distance: str
    """One of `DISTANCES`."""
    tilts: frozenset[str]
    """Those of `TILTS` that the board has; none where it faces the camera."""


class Coverage:
    """Counts what views show."""

    def __init__(self) -> None:
        self._seen: Counter[tuple[int, int] | str] = Counter()

    @property
    def cells(self) -> NDArray[np.intp]:
        """How many views have corners in each part of the image (rows, columns)."""
        columns, rows = CELLS
        return np.array([[self._seen[column, row] for column in range(columns)] for row in range(rows)])

    def add(self, traits: Traits) -> None:
        """Count a view."""
        self._seen.update((*traits.cells, traits.distance, *traits.tilts))

    def needs(self) -> tuple[Need, ...]:
        """Everything that is needed, met or not: regions row by row, distances, tilts."""
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
        """What is needed and not met."""
        return tuple(need for need in self.needs() if not need.met)

    def adds(self, traits: Traits) -> Iterator[Need]:
        """The unmet needs that a view would serve."""
        shown = {*traits.cells, traits.distance, *traits.tilts}
        for need in self.missing():
            if (need.cell or need.name) in shown:
                yield need


def region_name(cell: tuple[int, int]) -> str:
    """Words for a part of the image: `upper left`, `middle`, and so on; several parts share a name."""
    (column, row), (columns, rows) = cell, CELLS
    across = ("left", "", "right")[column * 3 // columns]
    down = "upper" if row == 0 else "lower" if row == rows - 1 else ""
    return f"{down} {across}".strip() if across or down else "middle"


def traits(view: View, pose: Pose, outline: Floats) -> Traits:
    """What a view shows of a board that is at a pose (board to camera), and whose outline (4, 2) is in pixels."""
    size = np.array(view.size)
    cells = np.clip(np.floor((view.corners + 0.5) / size * CELLS), 0, np.array(CELLS) - 1).astype(int)
    return Traits(frozenset(map(tuple, cells.tolist())), _distance(outline, view.size), frozenset(_tilts(pose)))


def _distance(outline: Floats, size: tuple[int, int]) -> str:
    x, y = outline.T
    area = abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2
    part = math.sqrt(area / (size[0] * size[1]))
    return DISTANCES[0] if part >= NEAR else DISTANCES[1] if part >= FAR else DISTANCES[2]


def _tilts(pose: Pose) -> Iterator[str]:
    """How the board's normal leans, in the image."""
    into = pose.rotation[:, 2]  # points away from the camera, and to the side that is nearer
    across, down = math.atan2(into[0], abs(into[2])), math.atan2(into[1], abs(into[2]))
    for angle, (negative, positive) in ((across, TILTS[:2]), (down, TILTS[2:])):
        if abs(angle) >= TILTED:
            yield positive if angle > 0 else negative
