"""Edge fit of markers: finds their corners with an accuracy of some hundredths of a pixel, and the corners' covariance.

The number of a marker determines where all its edges are: the outer ones, and those between black and white cells
(modules). Pixels near the edges are compared with a model of the pattern, which a homography maps to the image.
Gauss-Newton steps change the homography, the blur, and the light. The blur is an ellipse, because motion blurs along
one direction. The light may vary linearly over the marker, and white areas may have grown: a camera that encodes or
clips bright light shifts all edges towards black.

Printers draw markers from images whose modules are no whole number of pixels. Then the lines between modules are not
where they should be, while the outer edges are. So the inner lines get offsets of their own if they disagree with the
outer edges.

The pixels are compared without interpolation, so their noise is independent. Therefore the covariance of the corners
follows from the variance of the residuals and the normal matrix.

All markers of a frame are fitted together. The shape (K, ..., N) means K markers with up to N pixels each.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverkit.vision.markers.edge_samples import (
    LIFTED,
    SQUARE,
    MarkerBatch,
    Pixels,
    apply,
    choose_pixels,
    homographies,
    make_batch,
    product,
)
from roverkit.vision.markers.pattern import Pattern, predict_grey
from roverkit.vision.poses.chi_squared import chi2_limit

# Why not OpenCV's refinements: SUBPIX looks for saddles, and the outer corners of a marker are none, which biases the
# size of the marker and so its distance. APRILTAG fits the four outer edges only; the edges between the bits are as
# sharp, and there are more of them. Errors of the translation on 60 rendered poses of each size, tilted by up to 60
# degrees, median in percent (OpenCV 5.0, `make bench-vision`):
#
#     side     no refinement   SUBPIX   APRILTAG   edge fit
#     24 px    4.1             2.4      0.38       0.027
#     48 px    2.1             0.89     0.11       0.014
#     96 px    0.80            0.33     0.08       0.005
#
# With motion blur of 6 px, the error at 48 px is 0.060 percent (APRILTAG 0.24), and with a print of 100 pixels 0.020
# (APRILTAG 0.10).
COARSE = 3
"""Stride of the first steps: they use only every third pixel, to be faster."""
COARSE_STEPS = 3
"""Largest number of Gauss-Newton steps with every `COARSE`-th pixel."""
FINE_STEPS = 8
"""Largest number of Gauss-Newton steps with all pixels."""
NEAR = 0.2
"""Motion of corners in pixels per step below which all pixels are used."""
SETTLED = 0.05
"""Motion of corners in pixels per step below which the fit has converged."""
UNSETTLED = 0.5
"""Motion of corners in pixels in the last step above which the fit has diverged."""
OUTLIER = 4.0
"""Residual, in standard deviations, above which a pixel gets no weight."""
FIRST_BLUR = 0.85
"""Standard deviation in pixels of a focused lens's blur, including the area of a pixel."""
BLURS = (0.4, 4.0)
"""Smallest and largest standard deviation of the blur in pixels, along any direction."""
# 8 of the homography, 3 of the blur, and 7 of the light: black and white, each with a gradient along u and v, and the
# growth of white areas. The offsets of inner lines follow.
_GEOMETRY, _LIGHT = 11, 7
_UNKNOWNS = _GEOMETRY + _LIGHT
_FEWEST = 4 * _UNKNOWNS  # fewest pixels of a fit
_RIGID = 1e12  # precision, relative to that of the pixels, that holds the inner lines where they should be
LINE_STEPS = 3
"""Largest number of Gauss-Newton steps with free inner lines."""
_MAD_TO_SIGMA = 1.4826  # for a normal distribution: 1 / 0.6745
_ROUNDING = 0.3  # standard deviation of rounding to whole grey levels: 1 / sqrt(12)
_RIDGE = 1e-9  # keeps the matrix of a marker without contrast invertible, for the sake of the others


@dataclass(frozen=True, slots=True, eq=False)
class Guess:
    """Marker to fit, with its approximate corners, at which the fit starts."""

    pattern: Pattern
    corners: Floats
    """Corners (4, 2) in pixels."""
    blur: float = FIRST_BLUR
    """Standard deviation of the blur in pixels at which the fit starts, usually from the previous frame."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """Result of the edge fit for one marker: its corners with their covariance, and the quality of the fit."""

    rays: Floats
    """Rays (4, 2) of the corners, in OpenCV's order; a ray is a point (x, y) in the plane z = 1."""
    covariance: Floats
    """Covariance (8, 8) of the corners' rays: x and y of the first corner, of the second, and so on."""
    noise: float
    """Standard deviation of the residuals in grey levels."""
    contrast: float
    """White minus black in grey levels; negative if they are swapped."""
    explained: float
    """Share of the pixels' variance that the pattern explains, including outliers; 1 for a perfect marker."""
    blur: float
    """Standard deviation of the blur in pixels."""


@dataclass(frozen=True, slots=True, eq=False)
class _State:
    """Unknowns of the fit for K markers, except the brightness."""

    homography: Floats
    """Homography (K, 3, 3) from the square (-1, -1)...(1, 1), v down, to scaled rays; the last element is 1."""
    blur: Floats
    """Covariance (K, 2, 2) of the blur in pixels squared."""
    lines: Floats
    """Offsets (K, 2, n - 2) of the inner lines between modules along u and v, in modules."""


@dataclass(frozen=True, slots=True, eq=False)
class _Outcome:
    """Result of one Gauss-Newton step of the edge fit, for K markers with up to N pixels each."""

    normal: Floats
    """Normal matrices (K, U, U) of the U unknowns: 18, and the offsets of inner lines if they are free."""
    right: Floats
    """Right sides (K, U) of the normal equations."""
    contrast: Floats
    """Contrast (K,) in grey levels, as in `Fit`."""
    residuals: Floats
    """Residuals (K, N) in grey levels before the step."""
    weights: Floats
    """Weights (K, N); 0 for outliers."""
    left: Floats
    """Residuals (K, N) after the step; 0 for outliers."""

    def variance(self) -> Floats:
        """Return the variance (K,) of the residuals after the step."""
        variance: Floats = _squares(self.left) / np.maximum(self.weights.sum(axis=1) - _UNKNOWNS, 1.0)
        return variance

    def explained(self, pixels: Pixels) -> Floats:
        """Return the share (K,) of the variance of the pixels that the model explains; 1 for a perfect marker."""
        mean = pixels.grey.sum(axis=1) / np.maximum(pixels.real.sum(axis=1), 1)
        spread = pixels.grey - mean[:, None] * pixels.real
        explained: Floats = 1 - _squares(self.residuals) / np.maximum(_squares(spread), 1e-9)
        return explained


def fit_edges(image: NDArray[np.uint8], camera: CameraParameters, guesses: Sequence[Guess]) -> list[Fit | None]:
    """Fit the edges of the markers in a grey image (H, W); each fit starts at the guess for the marker.

    The result for a marker is None if too little of the marker is visible, or if there is no marker.
    """
    if not guesses:
        return []
    rays = camera.undistort(np.stack([guess.corners for guess in guesses]))
    visible = np.isfinite(rays).all(axis=(1, 2))
    rays[~visible] = SQUARE.T  # any valid numbers
    batch = make_batch([guess.pattern for guess in guesses], rays)
    scaled = (rays - batch.centre[:, None]) / batch.scale[:, None, None]
    blurs = np.clip([guess.blur for guess in guesses], *BLURS)
    state = _State(
        homographies(scaled.transpose(0, 2, 1)),
        blurs[:, None, None] ** 2 * np.eye(2),
        np.zeros((len(guesses), 2, guesses[0].pattern.modules - 1)),
    )
    with np.errstate(all="ignore"):  # a wrong guess may diverge; it is rejected below
        pixels = choose_pixels(image, camera, batch, state.homography)
        coarse = pixels.every(COARSE)
        pixel = batch.scale * float(np.max(camera.focal))  # pixels per unit of the scaled rays
        for _ in range(COARSE_STEPS):
            before, (state, _unused) = state, _step(batch, state, coarse)
            if not (_shift(before, state) * pixel > NEAR)[visible].any():
                break
        for _ in range(FINE_STEPS):
            before, (state, outcome) = state, _step(batch, state, pixels)
            shift = _shift(before, state) * pixel
            if not (shift > SETTLED)[visible].any():
                break
        visible &= (pixels.real.sum(axis=1) >= _FEWEST) & (shift < UNSETTLED)
        rigidity = _rigidity(_step(batch, state, pixels, np.full(len(guesses), _RIGID))[1])
        if (rigidity < _RIGID)[visible].any():
            for _ in range(LINE_STEPS):
                before, (state, outcome) = state, _step(batch, state, pixels, rigidity)
                if not (_shift(before, state) * pixel > SETTLED)[visible].any():
                    break
        variance, explained = outcome.variance(), outcome.explained(pixels)
    return [
        _fit(batch, state, outcome, k, float(variance[k]), float(explained[k])) if visible[k] else None
        for k in range(len(guesses))
    ]


def _step(batch: MarkerBatch, state: _State, pixels: Pixels, rigidity: Floats | None = None) -> tuple[_State, _Outcome]:
    """Make one Gauss-Newton step for all markers, in which outliers have no weight; return the new state.

    With `rigidity` (K,), the inner lines between modules are free. It is the precision with which they are known to be
    where they should be, relative to that of a pixel.
    """
    design, square = _design(batch, state, pixels, with_lines=rigidity is not None)
    light = design[:, _GEOMETRY:_UNKNOWNS]
    level = _solve(light @ light.transpose(0, 2, 1), light @ pixels.grey[:, :, None])
    residuals = pixels.grey - (level[:, None] @ light)[:, 0]
    contrast = level[:, 3, None] + (level[:, None, 4:6] @ square)[:, 0]
    # Variable projection: the light is solved linearly first, then all unknowns take one step together.
    design[:, :_GEOMETRY] *= contrast[:, None]
    design[:, _UNKNOWNS:] *= contrast[:, None]
    weights = _weights(residuals, pixels.real)
    weighted = design * weights[:, None]
    normal, right = weighted @ design.transpose(0, 2, 1), weighted @ residuals[:, :, None]
    if rigidity is not None:
        free = np.arange(_UNKNOWNS, normal.shape[1])
        normal[:, free, free] += rigidity[:, None]
        right[:, free, 0] -= rigidity[:, None] * state.lines.reshape(len(normal), -1)
    change = _solve(normal, right)
    left = weights * (residuals - (change[:, None] @ design)[:, 0])
    homography = state.homography.copy()
    homography.reshape(-1, 9)[:, :8] += change[:, :8]
    blur = _possible(state.blur + change[:, [8, 9, 9, 10]].reshape(-1, 2, 2))
    lines = state.lines + change[:, _UNKNOWNS:].reshape(state.lines.shape) if rigidity is not None else state.lines
    moved = _State(homography, blur, lines)
    return moved, _Outcome(normal, right[..., 0], level[:, 3], residuals, weights, left)


def _possible(blur: Floats) -> Floats:
    """Return the covariances (K, 2, 2) of blurs with their standard deviations limited to `BLURS`."""
    variances, axes = np.linalg.eigh(np.where(np.isfinite(blur), blur, np.eye(2)))
    variances = np.clip(variances, BLURS[0] ** 2, BLURS[1] ** 2)
    possible: Floats = (axes * variances[:, None]) @ np.swapaxes(axes, 1, 2)
    return possible


def _rigidity(outcome: _Outcome) -> Floats:
    """Return the precision (K,) with which inner lines are where they should be, relative to that of a pixel.

    `outcome` is a step in which the lines were held by `_RIGID`. It is linear in the unknowns, so the offsets that the
    lines would have without this can be computed from it. Prints that were rastered have misplaced inner lines, and so
    has bent paper; the outer edges are then the only ones that determine the marker. The variance of the offsets is
    estimated with the method of DerSimonian and Laird (1986).
    """
    normal = outcome.normal.copy()
    free = np.arange(_UNKNOWNS, normal.shape[1])
    normal[:, free, free] -= _RIGID
    normal[:, free, free] += _RIDGE * (1 + normal[:, free, free])
    inverse = np.linalg.inv(np.where(np.isfinite(normal), normal, 0) + _RIDGE * np.eye(normal.shape[1]))
    offsets = (inverse @ outcome.right[:, :, None])[:, free, 0]
    variance = outcome.variance()
    precision = 1 / np.maximum(inverse.diagonal(axis1=1, axis2=2)[:, free], 1e-12) / variance[:, None]
    chi2 = (offsets**2 * precision).sum(axis=1)
    excess = (chi2 - free.size) / precision.sum(axis=1)
    return np.where(chi2 > chi2_limit(free.size), variance / np.maximum(excess, 1e-12), _RIGID)


def _shift(before: _State, after: _State) -> Floats:
    """Return the largest motion (K,) of a corner of each marker between two states, in units of the scaled rays."""
    places = [lifted[:, :2] / lifted[:, 2:] for lifted in (before.homography @ LIFTED, after.homography @ LIFTED)]
    distance: Floats = np.hypot(*(places[1] - places[0]).transpose(1, 0, 2)).max(axis=1)
    return distance


def _squares(values: Floats) -> Floats:
    total: Floats = np.einsum("kn,kn->k", values, values)
    return total


def _solve(normal: Floats, right: Floats) -> Floats:
    """Return the solutions (K, n) of K systems of normal equations: matrices (K, n, n), right sides (K, n, 1)."""
    diagonal = np.einsum("kii->ki", normal)
    diagonal += _RIDGE * (diagonal + 1)
    return np.linalg.solve(normal, right)[..., 0]


def _weights(residuals: Floats, real: Floats) -> Floats:
    """Return the weights (K, N) of pixels: 0 for outliers and padding, 1 for all others."""
    sizes = np.abs(residuals) - (1 - real)  # padding sorts first
    count = real.sum(axis=1).astype(np.intp)
    middle = np.sort(sizes, axis=1)[
        np.arange(len(sizes)), np.minimum(real.shape[1] - count + count // 2, real.shape[1] - 1)
    ]
    limit = OUTLIER * (_MAD_TO_SIGMA * middle + _ROUNDING)
    return np.where(np.abs(residuals) < limit[:, None], real, 0.0)


def _design(batch: MarkerBatch, state: _State, pixels: Pixels, *, with_lines: bool) -> tuple[Floats, Floats]:
    """Return the derivatives (K, U, N) of the model, and the positions (K, 2, N) of the pixels in the marker's square.

    The derivatives are with respect to 8 elements of the homography, 3 of the blur, 7 coefficients of the light, and
    the offsets of the inner lines if `with_lines` is true. All but those of the light are for a contrast of 1. If the
    homography moves while the pixel stays, the pixel sees the pattern move in the opposite direction.
    """
    square, by_point = apply(np.linalg.inv(state.homography), pixels.points)
    by_pixel = product(by_point, pixels.by_pixel) * batch.half
    places = square * batch.half + batch.half
    predicted = predict_grey(batch.differences, places, by_pixel, state.blur, state.lines, with_lines=with_lines)
    w = (state.homography[:, 2:, :2] @ square)[:, 0] + 1
    by_place = predicted.by_u[:, None] * by_point[:, 0] + predicted.by_v[:, None] * by_point[:, 1]
    by_place *= (-batch.half * pixels.real / w)[:, None]
    design = np.empty((len(square), _UNKNOWNS + predicted.by_lines.shape[1], square.shape[2]))
    design[:, 0:2] = by_place[:, :1] * square
    design[:, 2] = by_place[:, 0]
    design[:, 3:5] = by_place[:, 1:] * square
    design[:, 5] = by_place[:, 1]
    design[:, 6:8] = -(by_place * pixels.points).sum(axis=1)[:, None] * square
    design[:, 8:11] = predicted.by_blur * pixels.real[:, None]
    design[:, 11] = pixels.real
    design[:, 12:14] = square * pixels.real[:, None]
    design[:, 14] = predicted.grey * pixels.real
    design[:, 15:17] = design[:, 14, None] * square
    design[:, 17] = predicted.by_growth * pixels.real
    design[:, _UNKNOWNS:] = predicted.by_lines * pixels.real[:, None]
    return design, square


def _fit(batch: MarkerBatch, state: _State, outcome: _Outcome, k: int, variance: float, explained: float) -> Fit | None:
    """Return the result of the fit for marker `k`; None if its covariance is not finite."""
    try:
        covariance = variance * np.linalg.inv(outcome.normal[k])[:8, :8]
    except np.linalg.LinAlgError:
        return None
    corners, by_homography = _corners(state.homography[k])
    if not np.isfinite(covariance).all() or not np.isfinite(corners).all():
        return None
    scale = float(batch.scale[k])
    return Fit(
        rays=corners * scale + batch.centre[k],
        covariance=by_homography @ covariance @ by_homography.T * scale**2,
        noise=math.sqrt(variance),
        contrast=float(outcome.contrast[k]),
        explained=explained,
        blur=float(np.linalg.det(state.blur[k])) ** 0.25,
    )


def _corners(homography: Floats) -> tuple[Floats, Floats]:
    """Return the corners (4, 2) of a marker as scaled rays, and their derivative (8, 8).

    The derivative is with respect to the elements of the homography. Only the first eight elements of the homography
    vary.
    """
    lifted = homography @ LIFTED
    corners = (lifted[:2] / lifted[2]).T
    place = (LIFTED / lifted[2]).T
    derivative = np.zeros((4, 2, 8))
    derivative[:, 0, :3] = derivative[:, 1, 3:6] = place
    derivative[:, :, 6:] = -corners[:, :, None] * place[:, None, :2]
    return corners, derivative.reshape(8, 8)
