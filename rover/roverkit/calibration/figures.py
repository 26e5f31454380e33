"""Figures of the calibration report, as SVG paths and rectangles. The unit is a pixel of the camera's image.

Coordinates are rounded, so that equal calibrations give equal bytes. In SVG, coordinates count from the corner of the
first pixel; in the camera model, from the centre of the first pixel.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roverkit.calibration.solution import Calibration
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.opencv import cv2

BOUNDS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
"""Bounds in pixels between the colours of the uncertainty figure; they are fixed, so that reports can be compared."""
_COLUMNS = 64
"""Number of rectangles across the figure of the uncertainty."""
_ARROW = 1 / 25
"""Drawn length of a long residual, as a fraction of the image width."""
_LONG = 95
"""Percentile of the residuals' lengths that counts as long."""
_SHORTEST_LONG = 1e-3
"""Least length in pixels that counts as long, so that tiny residuals are not magnified without limit."""
_CORNER = 0.5


@dataclass(frozen=True, slots=True)
class Field:
    """Rectangle of the image in which all pixels have the same class, such as a class of uncertainty: its `level`."""

    x: float
    y: float
    width: float
    height: float
    level: int


@dataclass(frozen=True, slots=True)
class Residuals:
    """Figure of the residuals: for each corner, a line from its expected to its observed position."""

    used: str
    """SVG path of the residuals of the corners that the calibration uses."""
    left_out: str
    """SVG path of the residuals of the corners that are left out."""
    magnified: float
    """Magnification of the lines: drawn length divided by length of the residual."""
    bar: float
    """Length in pixels that the scale bar stands for; the bar is drawn `bar * magnified` pixels long."""


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """Figure of the uncertainty of the calibration over the image."""

    fields: list[Field]
    """Rectangles that cover the image; a level is the number of `BOUNDS` that the standard deviation reaches."""
    seen: str
    """SVG path around all used corners; outside it the camera model is extrapolated."""
    inside: float
    """Largest standard deviation inside the path in pixels."""
    outside: float | None
    """Largest standard deviation in the whole image; None if the model has no ray for some part of it."""


def residuals(calibration: Calibration) -> Residuals:
    """Return the figure with a line from the expected position of each corner towards its observed position."""
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
    """Return the figure of the uncertainty: the standard deviation in pixels, for rectangles all over the image."""
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
    """Return an SVG path with a dot at each point (N, 2). A dot is a line of length 0 with round ends."""
    return "".join(f"M{x:.1f} {y:.1f}h0" for x, y in places + _CORNER)


def arrows(places: Floats, misses: Floats, magnified: float) -> str:
    """Return an SVG path with a line from each point (N, 2) along its residual (N, 2), multiplied by `magnified`."""
    return "".join(
        f"M{x:.1f} {y:.1f}l{dx:.1f} {dy:.1f}" for (x, y), (dx, dy) in zip(places + _CORNER, misses * magnified)
    )


def fields(levels: NDArray[np.intp], size: tuple[int, int]) -> list[Field]:
    """Return rectangles for an image of `size`, given the class of each cell of a grid (rows, columns).

    Neighbouring cells with the same class become one rectangle.
    """
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
    """Return the largest number of the series ... 0.1, 0.2, 0.5, 1, 2, 5, 10 ... that is not greater than `value`."""
    power = 10.0 ** math.floor(math.log10(value))
    return max(step * power for step in (1, 2, 5) if step * power <= value)


def _corners(calibration: Calibration) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Return the positions (N, 2), the residuals (N, 2), and the mask (N,) of used corners, of all views together.

    Views whose residuals are not known are left out.
    """
    judged = [fitted for fitted in calibration.views if np.isfinite(fitted.residuals).all()]
    return (
        np.concatenate([fitted.view.corners for fitted in judged]),
        np.concatenate([fitted.residuals for fitted in judged]),
        np.concatenate([fitted.used for fitted in judged]),
    )
