"""Model of a marker's pattern as a camera sees it: the grey values near all edges, blurred.

A module is one black or white cell of the marker. The corners of the modules form a lattice: line i along u and line j
along v cross at the lattice point (i, j). D[j, i] is the mixed difference of black (0) and white (1) modules there.
With (u, v) in modules from the upper left outer corner, the grey value is

    grey(u, v) = 1 + sum over i, j of D[j, i] * P(a_i, b_j; r)      a_i = (u - i) / su      b_j = (v - j) / sv

su and sv are the standard deviations of the blur, measured across the lines of u and of v, and r is its correlation: 0
if the lines meet at right angles. P is the bivariate normal distribution function, computed by Mehler's series up to
the second power of r:

    P(a, b; r) = step(a) step(b) + r bell(a) bell(b) + r^2 / 2 curve(a) curve(b)

`step` is the normal distribution function, `bell` its derivative, the density, and curve(x) = x bell(x). So all that is
needed are sums of D[j, i] f(a_i) g(b_j), where f and g are among these three functions. The derivatives with respect
to u, v and the lines are those for r = 0: a Gauss-Newton step needs no exact ones.

Several markers are processed together, because numpy is slow on small arrays: K markers with N pixels each. L is the
number of lines of the lattice along u, and along v.
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
_SATURATED = 3.5  # distance, in standard deviations, from which `step` counts as 0 or 1: an error of 1/20 grey level
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
class PredictedGrey:
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
    """Derivative (K, 2 * (L - 2), N) with respect to `lines`; has no rows if they were not requested."""


@dataclass(frozen=True, slots=True, eq=False)
class _Blur:
    """Blur at each pixel, along the axes u and v of the marker (the second axis of the arrays)."""

    variance: Floats
    """Variances (K, 2, N) su^2 and sv^2, in modules squared."""
    sigma: Floats
    """Standard deviations (K, 2, N) su and sv, in modules."""
    correlation: Floats
    """Correlation (K, N) of the blur along u and along v."""


@dataclass(frozen=True, slots=True, eq=False)
class _Window:
    """Modules around each pixel that the blur mixes, W + 1 along both axes, and the W lines between them.

    Beyond these lines, `step` is 0 or 1, and the other functions are 0.
    """

    first: NDArray[np.intp]
    """Indices (K, 2, N) of the first line along u and along v."""
    modules: Singles
    """Grey values (W + 1, W + 1, K, N) of the modules minus 1, rows along v."""


@dataclass(frozen=True, slots=True, eq=False)
class _LineValues:
    """Values of `step`, `bell` and `curve` (the first axis of the arrays) at the lines of the pixels' windows."""

    lines: Singles
    """f(a_i) and f(b_j), of shape (3, W, K, 2, N)."""
    modules: Singles
    """Decrease of f from one module of the window to the next one, along u and v, of shape (3, W + 1, K, 2, N)."""
    summed: Singles
    """Sums (3, W + 1, K, N) over the modules along u, for each row of modules along v."""


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


def predict_grey(
    differences: Floats,
    places: Floats,
    by_pixel: Floats,
    blur: Floats,
    lines: Floats | None = None,
    *,
    with_lines: bool = False,
) -> PredictedGrey:
    """Compute the grey values of the model of K markers at the points `places`, and their derivatives.

    `places` (K, 2, N) are u and v in modules (cells of the marker). `by_pixel` (K, 2, 2, N) is their derivative with
    respect to the pixel coordinates. `differences` (K, L, L) are those of the patterns. `blur` (K, 2, 2) is the
    covariance of the blur in pixels squared. `lines` (K, 2, L - 2) are the offsets of the inner lines of the lattice
    along u and v, in modules; None means none. The values per line of the lattice have single precision, which is
    faster and exact to some hundredths of a grey level.
    """
    local = _blur_along_axes(by_pixel, blur)
    sigma_u, sigma_v, r = local.sigma[:, 0], local.sigma[:, 1], local.correlation
    window = _window(differences, places, local)
    values = _line_values(window, _distances(window, differences, places, local, lines))
    # The sums of D[j, i] f(a_i) g(b_j) over all lattice points (i, j), for f and g in the order step, bell, curve. Each
    # is the sum over all modules, each with its value and the decrease of f and g from one side of it to the other
    # (summation by parts).
    sums = _sum_of_products(values.summed[:, None], values.modules[None, :, :, :, 1])
    first, second = sums[1, 1], sums[2, 2]  # terms of r and of r^2 / 2
    by_u, by_v = sums[1, 0] / sigma_u, sums[0, 1] / sigma_v
    by_r = first + r * second
    # With respect to ln su and ln sv: a_i or b_j becomes smaller, and so does r = covariance / (su sv).
    by_log_sigmas = -sums[2, 0] - r * by_r, -sums[0, 2] - r * by_r
    (ux, uy), (vx, vy) = np.moveaxis(by_pixel, (1, 2), (0, 1))
    return PredictedGrey(
        grey=1 + sums[0, 0] + r * (first + r / 2 * second),
        by_u=by_u,
        by_v=by_v,
        by_blur=_by_blur(by_pixel, local, by_log_sigmas, by_r),
        by_growth=np.hypot(by_u * ux + by_v * vx, by_u * uy + by_v * vy),
        by_lines=(
            _by_lines(window, differences.shape[1], local, values)
            if with_lines
            else np.empty((len(places), 0, r.shape[1]))
        ),
    )


def _blur_along_axes(by_pixel: Floats, blur: Floats) -> _Blur:
    """Return the blur along u and v.

    With the gradients gu and gv (2,) of u and v and the covariance C of the blur, su^2 is gu C gu, sv^2 is gv C gv, and
    the correlation is gu C gv / (su sv).
    """
    rows = blur[:, :, None, :, None]
    blurred = rows[:, 0] * by_pixel[:, :, :1] + rows[:, 1] * by_pixel[:, :, 1:]  # C gu and C gv
    variance = (by_pixel * blurred).sum(axis=2)
    sigma = np.sqrt(variance)
    covariance = (by_pixel[:, 0] * blurred[:, 1]).sum(axis=1)
    return _Blur(variance, sigma, covariance / (sigma[:, 0] * sigma[:, 1]))


def _window(differences: Floats, places: Floats, blur: _Blur) -> _Window:
    """Return the modules around each pixel; their number follows from the largest blur."""
    markers, lines, _ = differences.shape
    widest = float(np.max(blur.sigma))
    width = min(max(math.ceil(2 * _SATURATED * widest), 1), lines) if widest < lines else lines
    first = np.clip(np.rint(places - (width - 1) / 2).astype(np.intp), 0, lines - width)
    # the sum of the mixed differences above and to the left of a module is its value
    values = np.zeros((markers, lines + 1, lines + 1), np.float32)
    values[:, 1:, 1:] = differences.cumsum(axis=1).cumsum(axis=2)
    index = (np.arange(markers)[:, None] * (lines + 1) + first[:, 1]) * (lines + 1) + first[:, 0]
    steps = np.arange(width + 1)
    offsets = steps[:, None] * (lines + 1) + steps
    return _Window(first, values.ravel().take(index + offsets[..., None, None]))


def _distances(window: _Window, differences: Floats, places: Floats, blur: _Blur, lines: Floats | None) -> Singles:
    """Return the distances (W, K, 2, N) a_i and b_j of the pixels from the lines, limited to `_REACH`."""
    lattice = window.first + np.arange(len(window.modules) - 1)[:, None, None, None]
    count = differences.shape[1]
    offsets = np.zeros((len(places), 2, count), np.float32)
    if lines is not None:
        offsets[:, :, 1:-1] = lines
    places_of_lines = lattice.astype(np.float32)
    if offsets.any():
        row = np.arange(len(places))[:, None, None] * 2 + np.arange(2)[:, None]
        places_of_lines += offsets.ravel().take(row * count + lattice)
    distances = (places.astype(np.float32) - places_of_lines) * (1 / blur.sigma).astype(np.float32)
    # unlike clip, these replace the NaN of a fit that has diverged
    limited: Singles = np.fmax(np.fmin(distances, _REACH, out=distances), -_REACH, out=distances)
    return limited


def _line_values(window: _Window, distances: Singles) -> _LineValues:
    """Return the values of `step`, `bell` and `curve` at the distances (W, K, 2, N) from the lines."""
    index = (distances * np.float32(_RESOLUTION) + np.float32(_REACH * _RESOLUTION + 0.5)).astype(np.intp)
    whole = np.zeros((3, len(distances) + 2, *distances.shape[1:]), np.float32)
    lines = whole[:, 1:-1]
    lines[0], lines[1] = _STEP.take(index), _BELL.take(index)
    np.multiply(distances, lines[1], out=lines[2])
    whole[0, 0] = 1  # before the window, `step` is 1, and after it 0
    modules = whole[:, :-1] - whole[:, 1:]
    summed = _sum_of_products(window.modules, modules[:, None, :, :, 0])
    return _LineValues(lines, modules, summed)


def _sum_of_products(left: Singles, right: Singles) -> Singles:
    """Return the products of arrays (A, B, C, K, N), which are broadcast, summed over C."""
    # numpy.einsum takes twice as long: its innermost loop is over C.
    products: Singles = (left * right).sum(axis=-3)
    return products


def _by_blur(by_pixel: Floats, blur: _Blur, by_log_sigmas: tuple[Floats, Floats], by_r: Floats) -> Floats:
    """Return the derivative (K, 3, N) of the grey values with respect to the elements xx, xy and yy of the blur.

    By the chain rule, from the derivatives with respect to ln su, ln sv and r. With the gradients (ux, uy) of u and
    (vx, vy) of v, the element xx changes su^2 by ux^2, sv^2 by vx^2, and the covariance of both by ux vx; and so on.
    """
    (ux, uy), (vx, vy) = np.moveaxis(by_pixel, (1, 2), (0, 1))
    by_variance_u, by_variance_v = (by_log_sigmas[axis] / (2 * blur.variance[:, axis]) for axis in (0, 1))
    by_covariance = by_r / (blur.sigma[:, 0] * blur.sigma[:, 1])
    return np.stack(
        [
            by_variance_u * ux * ux + by_variance_v * vx * vx + by_covariance * ux * vx,
            2 * (by_variance_u * ux * uy + by_variance_v * vx * vy) + by_covariance * (ux * vy + uy * vx),
            by_variance_u * uy * uy + by_variance_v * vy * vy + by_covariance * uy * vy,
        ],
        axis=1,
    )


def _by_lines(window: _Window, count: int, blur: _Blur, of_lines: _LineValues) -> Floats:
    """Return the derivative (K, 2 * (L - 2), N) of the grey values with respect to the offsets of the inner lines.

    `count` is L. For line i along u, it is the sum of -D[j, i] bell(a_i) step(b_j) / su over j; for line j along v
    likewise over i. It is 0 for the lines outside of the window.
    """
    across = (np.diff(window.modules, axis=1) * of_lines.modules[0, :, None, :, 1]).sum(axis=0)
    values = np.stack([across, np.diff(of_lines.summed[0], axis=0)], axis=2) * of_lines.lines[1]
    values /= -blur.sigma.astype(np.float32)
    markers, axes, pixels = window.first.shape
    by_lines = np.zeros((markers, axes, count, pixels), np.float32)
    of_axis = np.arange(markers * axes).reshape(markers, axes, 1) * count + window.first
    for place, value in enumerate(values):
        by_lines.ravel()[(of_axis + place) * pixels + np.arange(pixels)] = value
    return by_lines[:, :, 1:-1].reshape(markers, -1, pixels)
