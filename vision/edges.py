"""Fits the edges of markers: their four corners to hundredths of a pixel, and how uncertain they are.

The number of a marker says where all its edges are, the outer ones and those between its bits. Pixels along them are
compared with what a camera sees of the `pattern` at a homography. Gauss-Newton steps move the homography, the width of
the blur, and the brightness, which may change linearly over the marker. It is the pixels themselves that are compared,
nothing is interpolated, so their noise is independent, and the residuals' variance, through the fit's normal matrix, is
the corners' covariance.

All markers of a frame are fitted together: arrays are (K, ..., N) for K markers with up to N pixels each.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.camera import CameraParameters, Floats
from vision.pattern import Pattern, look

ACROSS = (-1.2, 0.0, 1.2)
"""How far from an edge pixels are taken, in pixels."""
CLEAR = 2.2
"""How far pixels stay away from what is behind the white rim, in pixels; the rim is at least one module wide."""
COARSE = 3
"""The first steps take every third pixel."""
COARSE_STEPS = 3
FINE_STEPS = 8
"""The most steps with all pixels."""
SETTLED, UNSETTLED = 0.05, 0.5
"""Pixels that corners move in a step: when the next step moves them by next to nothing, and when they run away."""
OUTLIER = 4.0
"""Pixels are dropped whose residual is so many standard deviations."""
FIRST_BLUR = 0.85
"""Standard deviation of a focused lens's blur in pixels, a pixel's area included."""
BLURS = (0.4, 4.0)
_LARGEST_CHANGE = 0.5  # of the blur's logarithm in one step
_UNKNOWNS = 15
_FEWEST = 4 * _UNKNOWNS  # pixels
_MAD_TO_SIGMA = 1.4826
_ROUNDING = 0.3  # standard deviation of rounding to whole grey levels
_RIDGE = 1e-9  # so that a marker without contrast does not stop the others
_SQUARE = np.array([[-1.0, 1, 1, -1], [-1.0, -1, 1, 1]])  # a marker's corners, v down, in OpenCV's order
_LIFTED = np.vstack([_SQUARE, np.ones(4)])


@dataclass(frozen=True, slots=True, eq=False)
class Guess:
    """A marker to be fitted: about where it is."""

    pattern: Pattern
    corners: Floats
    """(4, 2) in pixels."""
    blur: float = FIRST_BLUR
    """Standard deviation of the blur in pixels, as in the frame before."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """The outcome for one marker."""

    rays: Floats
    """The corners (4, 2) as rays, in OpenCV's order."""
    covariance: Floats
    """Of the corners' rays (8, 8): x and y of the first, x and y of the second..."""
    noise: float
    """Standard deviation of the residuals in grey levels."""
    contrast: float
    """White minus black in grey levels; negative where they are swapped."""
    explained: float
    """Part of the pixels' variance that the pattern explains, outliers included: 1 is a perfect marker."""
    blur: float
    """Standard deviation of the blur in pixels."""


@dataclass(frozen=True, slots=True, eq=False)
class _Views:
    """The markers before the fit."""

    differences: Floats
    """(K, n, n)"""
    places: Floats
    """(K, 2, M) in modules."""
    across_u: NDArray[np.bool_]
    """(K, M)"""
    real: NDArray[np.bool_]
    """(K, M), false for what fills up rows."""
    half: float
    """Half the modules a side."""
    centre: Floats
    """(K, 2), the middle of the corners' rays."""
    scale: Floats
    """(K,), their extent: the fit works with rays that are centred and scaled by these."""


@dataclass(frozen=True, slots=True, eq=False)
class _State:
    """What the steps move, besides the brightness."""

    homography: Floats
    """(K, 3, 3) from (-1, -1)...(1, 1), v down, to scaled rays; the last element is 1."""
    log_blur: Floats
    """(K,)"""


@dataclass(frozen=True, slots=True, eq=False)
class _Pixels:
    grey: Floats
    """(K, N), 0 where not real."""
    points: Floats
    """Scaled rays (K, 2, N)."""
    by_pixel: Floats
    """The derivative (K, 2, 2, N) of the points by the pixels' coordinates."""
    real: Floats
    """(K, N): 1, and 0 for what fills up rows."""

    def every(self, stride: int) -> _Pixels:
        return _Pixels(*(part[..., ::stride] for part in (self.grey, self.points, self.by_pixel, self.real)))


@dataclass(frozen=True, slots=True, eq=False)
class _Outcome:
    normal: Floats
    """(K, 15, 15)"""
    variance: Floats
    """(K,) of the residuals that are left."""
    explained: Floats
    contrast: Floats


def fit_edges(image: NDArray[np.uint8], camera: CameraParameters, guesses: Sequence[Guess]) -> list[Fit | None]:
    """Fit each marker near its guess in a grey image (H, W). None where too little of it is seen, or it is none."""
    if not guesses:
        return []
    rays = camera.undistort(np.stack([guess.corners for guess in guesses]))
    visible = np.isfinite(rays).all(axis=(1, 2))
    rays[~visible] = _SQUARE.T  # anything that can be computed with
    views = _views([guess.pattern for guess in guesses], rays)
    scaled = (rays - views.centre[:, None]) / views.scale[:, None, None]
    blurs = np.clip([guess.blur for guess in guesses], *BLURS)
    state = _State(_homographies(scaled.transpose(0, 2, 1)), np.log(blurs))
    with np.errstate(all="ignore"):  # of a guess that was wrong anything may come; it is left out below
        pixels = _pixels(image, camera, views, state.homography)
        coarse = pixels.every(COARSE)
        for _ in range(COARSE_STEPS):
            state, _unused = _step(views, state, coarse)
        for _ in range(FINE_STEPS):
            before = state
            state, outcome = _step(views, before, pixels)
            shift = _shift(before, state) * views.scale * float(np.max(camera.focal))
            if not (shift[visible] > SETTLED).any():
                break
        visible &= (pixels.real.sum(axis=1) >= _FEWEST) & (shift < UNSETTLED)
        return [_fit(views, state, outcome, k) if visible[k] else None for k in range(len(guesses))]


def _views(patterns: Sequence[Pattern], rays: Floats) -> _Views:
    """Put patterns of several lengths into arrays."""
    most = max(pattern.across_u.size for pattern in patterns)
    places = np.zeros((len(patterns), 2, most))
    across_u, real = np.zeros((2, len(patterns), most), dtype=bool)
    for k, pattern in enumerate(patterns):
        count = pattern.across_u.size
        places[k, :, :count], across_u[k, :count], real[k, :count] = pattern.places, pattern.across_u, True
    centre = rays.mean(axis=1)
    return _Views(
        differences=np.stack([pattern.differences for pattern in patterns]),
        places=places,
        across_u=across_u,
        real=real,
        half=patterns[0].modules / 2,
        centre=centre,
        scale=np.abs(rays - centre[:, None]).max(axis=(1, 2)),
    )


def _homographies(points: Floats) -> Floats:
    """The homographies (K, 3, 3), their last element 1, from the square to points (K, 2, 4)."""
    u, v = _SQUARE
    rows = np.zeros((len(points), 2, 4, 8))
    rows[:, 0, :, :3] = rows[:, 1, :, 3:6] = _LIFTED.T
    rows[:, :, :, 6] = -u * points
    rows[:, :, :, 7] = -v * points
    solution = np.linalg.solve(rows.reshape(-1, 8, 8), points.reshape(-1, 8, 1))
    return np.concatenate([solution[..., 0], np.ones((len(points), 1))], axis=1).reshape(-1, 3, 3)


def _apply(homography: Floats, points: Floats) -> tuple[Floats, Floats]:
    """The images (K, 2, N) of points (K, 2, N), and their derivative (K, 2, 2, N)."""
    lifted = homography[:, :, :2] @ points + homography[:, :, 2:]
    images = lifted[:, :2] / lifted[:, 2:]
    slope = homography[:, :2, :2, None] - images[:, :, None] * homography[:, 2, None, :2, None]
    return images, slope / lifted[:, 2, None, None]


def _inverse(matrices: Floats) -> Floats:
    """The inverses of 2x2 matrices (K, 2, 2, N)."""
    a, b, c, d = matrices[:, 0, 0], matrices[:, 0, 1], matrices[:, 1, 0], matrices[:, 1, 1]
    swapped: Floats = np.stack([d, -b, -c, a], axis=1).reshape(matrices.shape)
    return swapped / (a * d - b * c)[:, None, None]


def _product(left: Floats, right: Floats) -> Floats:
    """The products of 2x2 matrices (K, 2, 2, N)."""
    return left[:, :, :1] * right[:, :1] + left[:, :, 1:] * right[:, 1:]


def _turned(matrices: Floats, vectors: Floats) -> Floats:
    """2x2 matrices (K, 2, 2, N) times vectors (K, 2, M, N)."""
    return matrices[:, :, :1] * vectors[:, None, 0] + matrices[:, :, 1:] * vectors[:, None, 1]


def _pixels(image: NDArray[np.uint8], camera: CameraParameters, views: _Views, homography: Floats) -> _Pixels:
    """The pixels along the patterns' edges. Their rays come from the edges' by the lens's slope there."""
    points, by_square = _apply(homography, views.places / views.half - 1)
    rays = points * views.scale[:, None, None] + views.centre[:, :, None]
    seen, slope = camera.distort_with_slope(rays.transpose(0, 2, 1))
    seen, by_pixel = seen.transpose(0, 2, 1), _inverse(np.moveaxis(slope, 1, -1)) / views.scale[:, None, None, None]
    modules_by_pixel = _product(_inverse(by_square) * views.half, by_pixel)
    modules_a_pixel = np.sqrt((modules_by_pixel**2).sum(axis=2))
    normal = modules_by_pixel / modules_a_pixel[:, :, None]
    normal = np.where(views.across_u[:, None], normal[:, 0], normal[:, 1])
    places = np.rint(seen[:, :, None] + np.array(ACROSS)[:, None] * normal[:, :, None])  # (K, 2, offsets, M)
    moved = places - seen[:, :, None]
    outside = np.abs(views.places[:, :, None] + _turned(modules_by_pixel, moved) - views.half) - views.half
    usable = (outside <= np.maximum(0, 1 - CLEAR * modules_a_pixel)[:, :, None]).all(axis=1) & views.real[:, None]
    height, width = image.shape
    usable &= (places >= 0).all(axis=1) & (places[:, 0] < width) & (places[:, 1] < height)
    index = np.where(usable, places[:, 1] * width + places[:, 0], 0).astype(np.intp)
    marker, chosen = _distinct(index, usable, image.size)
    start = np.searchsorted(marker, np.arange(len(index) + 1))
    row = np.arange(marker.size) - start[marker]
    moved_points = points[:, :, None] + _turned(by_pixel, moved)
    flat = moved_points.reshape(len(index), 2, -1)
    count = max(int(np.diff(start).max(initial=0)), 1)
    edge = chosen % seen.shape[2]
    grey, real = np.zeros((2, len(index), count))
    out_points, out_slopes = np.zeros((len(index), 2, count)), np.zeros((len(index), 2, 2, count))
    out_slopes[:, 0, 0] = out_slopes[:, 1, 1] = 1
    grey[marker, row] = image.ravel()[index.reshape(len(index), -1)[marker, chosen]]
    real[marker, row] = 1
    out_points[marker, :, row] = flat[marker, :, chosen]
    out_slopes[marker, :, :, row] = by_pixel[marker, :, :, edge]
    return _Pixels(grey, out_points, out_slopes, real)


def _distinct(
    index: NDArray[np.intp], usable: NDArray[np.bool_], size: int
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Each usable pixel once: its marker, in rising order, and its place among the marker's."""
    each = index[0].size
    keys = (index + np.arange(len(index))[:, None, None] * size)[usable]
    _, first = np.unique(keys, return_index=True)
    place = np.flatnonzero(usable)[first]
    return place // each, place % each


def _step(views: _Views, state: _State, pixels: _Pixels) -> tuple[_State, _Outcome]:
    """One Gauss-Newton step, without the pixels that stand out."""
    design, square = _design(views, state, pixels)
    light = design[:, 9:]
    level = _solve(light @ light.transpose(0, 2, 1), light @ pixels.grey[:, :, None])
    residuals = pixels.grey - (level[:, None] @ light)[:, 0]
    contrast = level[:, 3, None] + (level[:, None, 4:] @ square)[:, 0]
    design[:, :9] *= contrast[:, None]
    weights = _weights(residuals, pixels.real)
    weighted = design * weights[:, None]
    normal = weighted @ design.transpose(0, 2, 1)
    change = _solve(normal, weighted @ residuals[:, :, None])
    left = weights * (residuals - (change[:, None] @ design)[:, 0])
    homography = state.homography.copy()
    homography.reshape(-1, 9)[:, :8] += change[:, :8]
    log_blur = state.log_blur + np.clip(change[:, 8], -_LARGEST_CHANGE, _LARGEST_CHANGE)
    moved = _State(homography, np.clip(log_blur, *np.log(BLURS)))
    mean = pixels.grey.sum(axis=1) / np.maximum(pixels.real.sum(axis=1), 1)
    spread = pixels.grey - mean[:, None] * pixels.real
    explained = 1 - _squares(residuals) / np.maximum(_squares(spread), 1e-9)
    variance = _squares(left) / np.maximum(weights.sum(axis=1) - _UNKNOWNS, 1.0)
    return moved, _Outcome(normal, variance, explained, level[:, 3])


def _shift(before: _State, after: _State) -> Floats:
    """How far (K,) the corners moved, in scaled rays."""
    places = [lifted[:, :2] / lifted[:, 2:] for lifted in (before.homography @ _LIFTED, after.homography @ _LIFTED)]
    distance: Floats = np.hypot(*(places[1] - places[0]).transpose(1, 0, 2)).max(axis=1)
    return distance


def _squares(values: Floats) -> Floats:
    total: Floats = np.einsum("kn,kn->k", values, values)
    return total


def _solve(normal: Floats, right: Floats) -> Floats:
    """The solutions (K, n) of normal equations (K, n, n) with right sides (K, n, 1)."""
    diagonal = np.einsum("kii->ki", normal)
    diagonal += _RIDGE * (diagonal + 1)
    return np.linalg.solve(normal, right)[..., 0]


def _weights(residuals: Floats, real: Floats) -> Floats:
    """1 (K, N) for pixels near the others in terms of their median, 0 for those that stand out."""
    sizes = np.abs(residuals) - (1 - real)  # what fills up rows comes first
    count = real.sum(axis=1).astype(np.intp)
    middle = np.sort(sizes, axis=1)[
        np.arange(len(sizes)), np.minimum(real.shape[1] - count + count // 2, real.shape[1] - 1)
    ]
    limit = OUTLIER * (_MAD_TO_SIGMA * middle + _ROUNDING)
    return np.where(np.abs(residuals) < limit[:, None], real, 0.0)


def _design(views: _Views, state: _State, pixels: _Pixels) -> tuple[Floats, Floats]:
    """The derivatives (K, 15, N) by homography, logarithm of the blur and brightness; the pixels' places in the square.

    The first nine are for a contrast of 1. A point that stays while the homography moves sees the pattern move the
    other way.
    """
    square, by_point = _apply(np.linalg.inv(state.homography), pixels.points)
    by_pixel = _product(by_point, pixels.by_pixel) * views.half
    seen = look(views.differences, square * views.half + views.half, by_pixel, np.exp(state.log_blur))
    w = (state.homography[:, 2:, :2] @ square)[:, 0] + 1
    by_place = seen.by_u[:, None] * by_point[:, 0] + seen.by_v[:, None] * by_point[:, 1]
    by_place *= (-views.half * pixels.real / w)[:, None]
    design = np.empty((len(square), _UNKNOWNS, square.shape[2]))
    design[:, 0:2] = by_place[:, :1] * square
    design[:, 2] = by_place[:, 0]
    design[:, 3:5] = by_place[:, 1:] * square
    design[:, 5] = by_place[:, 1]
    design[:, 6:8] = -(by_place * pixels.points).sum(axis=1)[:, None] * square
    design[:, 8] = seen.by_blur * pixels.real
    design[:, 9] = pixels.real
    design[:, 10:12] = square * pixels.real[:, None]
    design[:, 12] = seen.grey * pixels.real
    design[:, 13:15] = design[:, 12, None] * square
    return design, square


def _fit(views: _Views, state: _State, outcome: _Outcome, k: int) -> Fit | None:
    """What came out for one marker."""
    try:
        covariance = outcome.variance[k] * np.linalg.inv(outcome.normal[k])[:8, :8]
    except np.linalg.LinAlgError:
        return None
    corners, by_homography = _corners(state.homography[k])
    if not np.isfinite(covariance).all() or not np.isfinite(corners).all():
        return None
    scale = float(views.scale[k])
    return Fit(
        rays=corners * scale + views.centre[k],
        covariance=by_homography @ covariance @ by_homography.T * scale**2,
        noise=math.sqrt(outcome.variance[k]),
        contrast=float(outcome.contrast[k]),
        explained=float(outcome.explained[k]),
        blur=math.exp(state.log_blur[k]),
    )


def _corners(homography: Floats) -> tuple[Floats, Floats]:
    """The corners (4, 2), and their derivative (8, 8) by the homography's first eight elements."""
    lifted = homography @ _LIFTED
    corners = (lifted[:2] / lifted[2]).T
    place = (_LIFTED / lifted[2]).T
    derivative = np.zeros((4, 2, 8))
    derivative[:, 0, :3] = derivative[:, 1, 3:6] = place
    derivative[:, :, 6:] = -corners[:, :, None] * place[:, None, :2]
    return corners, derivative.reshape(8, 8)
