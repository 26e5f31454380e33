"""Model of a marker's pattern as a camera sees it: the grey values near all edges, blurred.

A module is one black or white cell of the marker. The corners of the modules form a lattice. With (u, v) in modules
from the upper left outer corner, the grey value is 1 + sum over the lattice points (i, j) of D[j, i] * P((u - i) / su,
(v - j) / sv). D are the mixed differences of black (0) and white (1) modules. P is the bivariate normal distribution
function. su and sv are the blur measured across the lines of u and v. P is computed with Mehler's series in the
correlation, which is 0 if the lines of the lattice meet at right angles.

Several markers are processed together, because numpy is slow on small arrays: K markers with N pixels each.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roverkit.vision.camera.camera_model import Floats

Singles = NDArray[np.float32]

ALONG = (1 / 4, 3 / 4)
"""Positions along a module's edge at which pixels are taken, in modules."""

# Tables, because numpy has no erf.
_REACH = 5.0  # range of the tables, in standard deviations
_RESOLUTION = 1600  # table entries per standard deviation: rounding errors are below 1/40 grey level
_GRID = np.arange(-_REACH, _REACH + 0.5 / _RESOLUTION, 1 / _RESOLUTION)
_STEP = np.array([0.5 * math.erfc(-x / math.sqrt(2)) for x in _GRID], np.float32)
_BELL = (np.exp(-0.5 * _GRID**2) / math.sqrt(2 * math.pi)).astype(np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """Pattern of a marker in the form that `fit_edges` needs.

    A module is one black or white cell of the marker. u and v are coordinates in modules, to the right and down from
    the upper left outer corner.
    """

    modules: int
    """Number of modules per side, including the black border."""
    differences: Floats
    """Mixed differences (modules + 1, modules + 1) at the corners of modules, rows along v and columns along u.

    With white as 1 and black as 0, a value is the sum of the upper left and the lower right module around the corner,
    minus the other two modules.
    """
    places: Floats
    """Points (2, M) on the edges between black and white modules: u and v."""
    across_u: NDArray[np.bool_]
    """Mask (M,) of the points whose edge is crossed along u; the others are crossed along v."""


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """Grey values (K, N) that the model of a marker predicts for pixels (0 black, 1 white), and their derivatives."""

    grey: Floats
    by_u: Floats
    """Derivative (K, N) with respect to u, in modules (cells of the marker)."""
    by_v: Floats
    """Derivative (K, N) with respect to v, in modules."""
    by_blur: Floats
    """Derivative (K, 3, N) with respect to the elements xx, xy and yy of the blur's covariance in pixels squared."""
    by_growth: Floats
    """Derivative (K, N) with respect to a growth of all white areas in pixels: the slope across the edges."""
    by_lines: Floats
    """Derivative (K, 2 * (n - 2), N) with respect to `lines`; has no rows if they were not requested."""


def make_pattern(white: NDArray[np.bool_]) -> Pattern:
    """Return the pattern for a marker; `white` (n, n) marks its white modules, border included, upper row first."""
    around = np.pad(white.astype(float), 1, constant_values=1.0)
    along = np.array(ALONG)
    places, across_u = [], []
    for axis in (0, 1):
        rows, columns = np.nonzero(np.diff(around, axis=axis))
        step = np.tile(along, rows.size)
        row, column = np.repeat(rows, along.size), np.repeat(columns, along.size)
        places.append(np.stack([column, row - 1 + step] if axis else [column - 1 + step, row]))
        across_u.append(np.full(row.size, axis == 1))
    differences = np.diff(np.diff(around, axis=0), axis=1)
    return Pattern(len(white), differences, np.concatenate(places, axis=1).astype(float), np.concatenate(across_u))


def look(
    differences: Floats,
    places: Floats,
    by_pixel: Floats,
    blur: Floats,
    lines: Floats | None = None,
    *,
    with_lines: bool = False,
) -> Look:
    """Compute the grey values of the model of K markers at the points `places`, and their derivatives.

    `places` (K, 2, N) are u and v in modules (cells of the marker). `by_pixel` (K, 2, 2, N) is their derivative with
    respect to the pixel coordinates. `differences` (K, n, n) are those of the patterns. `blur` (K, 2, 2) is the
    covariance of the blur in pixels squared. `lines` (K, 2, n - 2) are the offsets of the inner lines of the lattice
    along u and v, in modules; None means none. The values per line of the lattice have single precision, which is
    faster and exact to some hundredths of a grey level.
    """
    blurred = np.einsum("kij,kajn->kain", blur, by_pixel)
    variance = (by_pixel * blurred).sum(axis=2)
    spread = np.sqrt(variance)
    both = spread[:, 0] * spread[:, 1]
    correlation = (by_pixel[:, 0] * blurred[:, 1]).sum(axis=1) / both
    lattice = np.arange(differences.shape[1], dtype=np.float32)[None, None]
    if lines is not None:
        lattice = lattice + np.pad(lines, ((0, 0), (0, 0), (1, 1))).astype(np.float32)
    narrow = (1 / spread).astype(np.float32)
    offsets = (places.astype(np.float32)[:, :, None] - lattice[..., None]) * narrow[:, :, None]
    np.clip(offsets, -_REACH, _REACH, out=offsets)  # (K, 2, lattice, N)
    index = (offsets * np.float32(_RESOLUTION) + np.float32(_REACH * _RESOLUTION + 0.5)).astype(np.intp)
    step, bell = _STEP.take(index), _BELL.take(index)
    curve = offsets * bell  # minus the bell's derivative
    differences = differences.astype(np.float32)
    of_step, of_bell, of_curve = (differences @ part[:, 0] for part in (step, bell, curve))
    crossing, bending = _sum(of_bell, bell), _sum(of_curve, curve)
    by_u, by_v = _sum(of_bell, step) / spread[:, 0], _sum(of_step, bell) / spread[:, 1]
    by_correlation = crossing + correlation * bending
    # The derivatives with respect to the logarithms of the spreads along u and v, which also change the correlation.
    by_spreads = (
        -_sum(of_curve, step) - correlation * by_correlation,
        -_sum(of_step, curve) - correlation * by_correlation,
    )
    (ux, uy), (vx, vy) = np.moveaxis(by_pixel, (1, 2), (0, 1))
    of_u, of_v, of_both = (
        by_spreads[0] / (2 * variance[:, 0]),
        by_spreads[1] / (2 * variance[:, 1]),
        by_correlation / both,
    )
    by_lines: Floats = np.empty((len(places), 0, places.shape[2]))
    if with_lines:
        across = np.swapaxes(differences, 1, 2) @ step[:, 1]
        by_lines = -np.concatenate(
            [
                (across * bell[:, 0] * narrow[:, :1])[:, 1:-1],
                (of_step * bell[:, 1] * narrow[:, 1:])[:, 1:-1],
            ],
            axis=1,
            dtype=np.float64,
        )
    return Look(
        grey=1 + _sum(of_step, step) + correlation * (crossing + correlation / 2 * bending),
        by_u=by_u,
        by_v=by_v,
        by_blur=np.stack(
            [
                of_u * ux * ux + of_v * vx * vx + of_both * ux * vx,
                2 * (of_u * ux * uy + of_v * vx * vy) + of_both * (ux * vy + uy * vx),
                of_u * uy * uy + of_v * vy * vy + of_both * uy * vy,
            ],
            axis=1,
        ),
        by_growth=np.hypot(by_u * ux + by_v * vx, by_u * uy + by_v * vy),
        by_lines=by_lines,
    )


def _sum(of_u: Singles, both: Singles) -> Floats:
    """Return the sum (K, N), over the lines of the lattice, of `of_u` (K, lines, N) times the v part of `both`."""
    total: Floats = np.einsum("kin,kin->kn", of_u, both[:, 1]).astype(np.float64)
    return total
