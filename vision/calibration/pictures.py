"""The pictures of the report, as paths and fields of SVG in pixels of the camera's image.

Coordinates are rounded, so that the same calibration gives the same bytes. SVG counts from the corner of the first
pixel, the camera from its centre.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roverlink.vision.calibration.solution import Calibration
from roverlink.vision.camera.camera_model import Floats
from roverlink.vision.opencv import cv2

BOUNDS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
"""Pixels between the classes of the uncertainty: fixed, so that reports can be compared."""
_COLUMNS = 64
"""Fields across the picture of the uncertainty."""
_ARROW = 1 / 25
"""Widths of the image that a long residual is drawn long."""
_LONG = 95
"""Percentile of the residuals' lengths at which one is long."""
_SHORTEST_LONG = 1e-3
"""Pixels; what is shorter is not magnified any more."""
_CORNER = 0.5


@dataclass(frozen=True, slots=True)
class Field:
    """A rectangle of one class."""

    x: float
    y: float
    width: float
    height: float
    level: int


@dataclass(frozen=True, slots=True)
class Residuals:
    """Where corners were seen, and how far from where they should be."""

    used: str
    """The lines of the corners that the calibration rests on."""
    left_out: str
    """The others'."""
    magnified: float
    """How many times longer than they are the lines are drawn."""
    bar: float
    """A residual in pixels that is drawn as a scale, `bar * magnified` long."""


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """How far from the truth the calibration puts what is seen, over the image."""

    fields: list[Field]
    """Their levels count the `BOUNDS` that are not above the deviation."""
    seen: str
    """A path around all corners that are used: what is outside is extrapolated."""
    inside: float
    """The largest standard deviation inside, in pixels."""
    outside: float | None
    """The largest in the whole image; None where the model has no direction for some part of it."""


def residuals(calibration: Calibration) -> Residuals:
    """Lines from every place where a corner should be towards where it was seen."""
    seen, misses, used = _corners(calibration)
    long = max(float(np.percentile(np.linalg.norm(misses[used], axis=1), _LONG)), _SHORTEST_LONG)
    magnified = round_down(calibration.views[0].view.size[0] * _ARROW / long)
    places = seen - misses
    return Residuals(
        arrows(places[used], misses[used], magnified),
        arrows(places[~used], misses[~used], magnified),
        magnified,
        round_down(long),
    )


def uncertainty(calibration: Calibration) -> Uncertainty:
    """The standard deviation of where a ray is seen, for fields of the image."""
    width, height = calibration.views[0].view.size
    rows = max(1, round(_COLUMNS * height / width))
    x, y = np.meshgrid((np.arange(_COLUMNS) + 0.5) * width / _COLUMNS, (np.arange(rows) + 0.5) * height / rows)
    places = np.stack([x, y], axis=-1) - _CORNER
    deviation = np.nan_to_num(calibration.uncertainty(places), nan=math.inf)
    seen, _, used = _corners(calibration)
    rim = cv2.convexHull(seen[used].astype(np.float32)).reshape(-1, 2)
    inside = [cv2.pointPolygonTest(rim, place, False) >= 0 for place in places.reshape(-1, 2).tolist()]
    return Uncertainty(
        fields(np.searchsorted(BOUNDS, deviation, side="right"), (width, height)),
        "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in rim + _CORNER) + "z",
        float(np.max(deviation.ravel()[inside])),
        float(np.max(deviation)) if np.isfinite(deviation).all() else None,
    )


def dots(places: Floats) -> str:
    """A path whose round ends are dots at places (N, 2)."""
    return "".join(f"M{x:.1f} {y:.1f}h0" for x, y in places + _CORNER)


def arrows(places: Floats, misses: Floats, magnified: float) -> str:
    """A path with a line from each place (N, 2) along its miss (N, 2), so many times as long."""
    return "".join(
        f"M{x:.1f} {y:.1f}l{dx:.1f} {dy:.1f}" for (x, y), (dx, dy) in zip(places + _CORNER, misses * magnified)
    )


def fields(levels: NDArray[np.intp], size: tuple[int, int]) -> list[Field]:
    """Rectangles of an image of `size` (width, height) that show classes (rows, columns); equal neighbours are one."""
    rows, columns = levels.shape
    width, height = size[0] / columns, size[1] / rows
    found = []
    for row, line in enumerate(levels):
        edges = [0, *(np.flatnonzero(np.diff(line)) + 1).tolist(), columns]
        for left, right in itertools.pairwise(edges):
            x, y, across, down = (
                round(value, 2) for value in (left * width, row * height, (right - left) * width, height)
            )
            found.append(Field(x, y, across, down, int(line[left])))
    return found


def round_down(value: float) -> float:
    """The largest of 1, 2, 5, 10, 20, 50 ... and of 0.5, 0.2, 0.1 ... that is not above a positive value."""
    power = 10.0 ** math.floor(math.log10(value))
    return max(step * power for step in (1, 2, 5) if step * power <= value)


def _corners(calibration: Calibration) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Of all views together: where corners were seen (N, 2), by how much that is off (N, 2), which are used (N,)."""
    judged = [fitted for fitted in calibration.views if np.isfinite(fitted.residuals).all()]
    return (
        np.concatenate([fitted.view.corners for fitted in judged]),
        np.concatenate([fitted.residuals for fitted in judged]),
        np.concatenate([fitted.used for fitted in judged]),
    )
