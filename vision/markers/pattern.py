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

from roverlink.vision.camera.camera_model import Floats

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
    """Derivative (K, N) with respect to the natural logarithm of the blur."""


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


def look(differences: Floats, places: Floats, by_pixel: Floats, blur: Floats) -> Look:
    """Compute the grey values of the model of K markers at the points `places`, and their derivatives.

    `places` (K, 2, N) are u and v in modules (cells of the marker). `by_pixel` (K, 2, 2, N) is their derivative with
    respect to the pixel coordinates. `differences` (K, n, n) are those of the patterns. `blur` (K,) is the standard
    deviation in pixels. The values per line of the lattice have single precision, which is faster and exact to some
    hundredths of a grey level.
    """
    spread = np.sqrt(by_pixel[:, :, 0] ** 2 + by_pixel[:, :, 1] ** 2)
    correlation = (by_pixel[:, 0] * by_pixel[:, 1]).sum(axis=1) / (spread[:, 0] * spread[:, 1])
    spread *= blur[:, None, None]
    lattice = np.arange(differences.shape[1], dtype=np.float32)[:, None]
    narrow = (1 / spread).astype(np.float32)
    offsets = (places.astype(np.float32)[:, :, None] - lattice) * narrow[:, :, None]  # (K, 2, lattice, N)
    np.clip(offsets, -_REACH, _REACH, out=offsets)
    index = (offsets * np.float32(_RESOLUTION) + np.float32(_REACH * _RESOLUTION + 0.5)).astype(np.intp)
    step, bell = _STEP.take(index), _BELL.take(index)
    curve = offsets * bell  # minus the bell's derivative
    differences = differences.astype(np.float32)
    of_step, of_bell, of_curve = (differences @ part[:, 0] for part in (step, bell, curve))
    crossing, bending = _sum(of_bell, bell), _sum(of_curve, curve)
    return Look(
        grey=1 + _sum(of_step, step) + correlation * (crossing + correlation / 2 * bending),
        by_u=_sum(of_bell, step) / spread[:, 0],
        by_v=_sum(of_step, bell) / spread[:, 1],
        by_blur=-_sum(of_curve, step) - _sum(of_step, curve),
    )


def _sum(of_u: Singles, both: Singles) -> Floats:
    """Return the sum (K, N), over the lines of the lattice, of `of_u` (K, lines, N) times the v part of `both`."""
    total: Floats = np.einsum("kin,kin->kn", of_u, both[:, 1]).astype(np.float64)
    return total
