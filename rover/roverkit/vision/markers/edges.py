"""Edge fit of markers: finds their corners with an accuracy of some hundredths of a pixel, and the corners' covariance.

The number of a marker determines where all its edges are: the outer ones, and those between black and white cells
(modules). Pixels near the edges are compared with a model of the pattern, which a homography maps to the image.
Gauss-Newton steps change the homography, the blur, and the light. The blur is an ellipse, because motion blurs along
one direction. The light may vary quadratically over the marker, black and white each in its own way, because a shadow
darkens and a highlight brightens a part of it. If the residuals show that this is not enough, it may vary with the
fourth power. White areas may have grown: a camera that encodes or clips bright light shifts all edges towards black.

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
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from roverkit.gating import gate_limit
from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverkit.vision.markers.edge_samples import MarkerBatch, Pixels, choose_pixels, make_batch, product
from roverkit.vision.markers.pattern import Pattern, predict_grey
from roverkit.vision.poses.homography import LIFTED, SQUARE, apply_with_derivative, homographies

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
COARSE = 2
"""Stride of the first steps: they use only every second pixel, to be faster."""
COARSE_STEPS = 3
"""Largest number of Gauss-Newton steps with every `COARSE`-th pixel."""
FINE_STEPS = 8
"""Largest number of Gauss-Newton steps with all pixels."""
COARSE_NEAR = 0.5
"""Motion of corners in pixels per step below which all pixels are used from the next step on."""
NEAR = 0.2
"""Motion of corners in pixels per step below which a marker of the previous frame has converged.

A Gauss-Newton step leaves an error that is quadratic in the motion: here less than half a standard deviation.
"""
SETTLED = 0.05
"""Motion as in `NEAR` for a marker whose inner lines are unknown: if misplaced, many pixels are outliers at first."""
UNSETTLED = 0.5
"""Motion of corners in pixels in the last step above which the fit has diverged."""
OUTLIERS = (3.0, 5.0)
"""Residuals, in standard deviations, from which a pixel loses weight, and above which it has none.

With a sudden end, pixels at the limit would come and go, and the fit would not settle.
"""
FIRST_BLUR = 0.85
"""Standard deviation in pixels of a focused lens's blur, including the area of a pixel."""
BLURS = (0.4, 4.0)
"""Smallest and largest standard deviation of the blur in pixels, along any direction."""
SMOOTH, LOCAL = 2, 4
"""Degrees of the light's polynomials: usually, and for a highlight or a shadow that is smaller than the marker."""
# 8 of the homography, 3 of the blur, and those of the light: black and contrast, each a polynomial of u and v, and the
# growth of white areas. The offsets of inner lines follow.
_GEOMETRY = 11
_CLIPPED = 255
_PIXELS = 4  # fewest pixels of a fit, for each unknown
RIGID = 1e12
"""Precision, relative to that of a pixel, that holds the inner lines where they should be."""
_MAD_TO_SIGMA = 1.4826  # for a normal distribution: 1 / 0.6745
_ROUNDING = 0.3  # standard deviation of rounding to whole grey levels: 1 / sqrt(12)
_RIDGE = 1e-9  # keeps the matrix of a marker without contrast invertible
_UNTHREADED = 1 << 18
"""Number of multiplications in a product of matrices up to which OpenBLAS starts no threads.

It is 65536 times the GEMM_MULTITHREAD_THRESHOLD of OpenBLAS. Where roverkit could not forbid the threads, they spin.
"""
_FEW = 4  # a step for up to a quarter of the markers takes half as long as for all of them

# The fit of a frame needs some megabytes for a moment. The allocator of glibc gives such memory back to the system, and
# gets it again page by page, which takes an eighth of the tracker's time. Freeing one large block raises its limits to
# the size of this block (mallopt(3): M_MMAP_THRESHOLD, M_TRIM_THRESHOLD). Elsewhere, this does nothing.
np.empty(1 << 24, np.uint8)


@dataclass(frozen=True, slots=True, eq=False)
class Guess:
    """Marker to fit, with its approximate corners, at which the fit starts."""

    pattern: Pattern
    corners: Floats
    """Corners (4, 2) in pixels."""
    blur: float = FIRST_BLUR
    """Standard deviation of the blur in pixels at which the fit starts, usually from the previous frame."""
    lines: Floats | None = None
    """Offsets (2, n - 2) of the inner lines in modules, from the previous frame; None if they are unknown."""
    rigidity: float = RIGID
    """Precision, relative to that of a pixel, with which the inner lines are where they should be."""
    doubtful: bool = False
    """True if there may be no marker, so that its pattern must explain more than usual."""


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
    lines: Floats
    """Offsets (2, n - 2) of the inner lines in modules, from where they should be."""
    rigidity: float
    """Precision, relative to that of a pixel, with which the inner lines are where they should be."""


@dataclass(frozen=True, slots=True, eq=False)
class _State:
    """Unknowns of the fit for K markers, except the brightness."""

    homography: Floats
    """Homography (K, 3, 3) from the square (-1, -1)...(1, 1), v down, to scaled rays; the last element is 1."""
    blur: Floats
    """Covariance (K, 2, 2) of the blur in pixels squared."""
    lines: Floats
    """Offsets (K, 2, n - 2) of the inner lines between modules along u and v, in modules."""

    def only(self, chosen: NDArray[np.intp]) -> _State:
        """Return a copy with only some of the markers."""
        return _State(self.homography[chosen], self.blur[chosen], self.lines[chosen])

    def put(self, chosen: NDArray[np.intp], moved: _State) -> None:
        """Replace the unknowns of some markers."""
        self.homography[chosen], self.blur[chosen], self.lines[chosen] = moved.homography, moved.blur, moved.lines


@dataclass(frozen=True, slots=True, eq=False)
class _Outcome:
    """Result of one Gauss-Newton step of the edge fit, for K markers with up to N pixels each."""

    normal: Floats
    """Normal matrices (K, U, U) of the U unknowns: `rigid`, and the offsets of inner lines if they may move."""
    right: Floats
    """Right sides (K, U) of the normal equations."""
    terms: Floats
    """Terms (K, T, N) of the light's polynomial at the pixels, each for black and for the contrast; 0 for padding."""
    contrast: Floats
    """Contrast (K,) in grey levels in the marker's middle, as in `Fit`."""
    residuals: Floats
    """Residuals (K, N) in grey levels before the step."""
    weights: Floats
    """Weights (K, N); 0 for outliers."""
    left: Floats
    """Residuals (K, N) after the step; 0 for outliers."""

    @property
    def rigid(self) -> int:
        """Number of unknowns without the offsets of inner lines."""
        return _GEOMETRY + 2 * len(self.terms[0]) + 1

    def variance(self) -> Floats:
        """Return the variance (K,) of the residuals after the step."""
        variance: Floats = _squares(self.left) / np.maximum(self.weights.sum(axis=1) - self.rigid, 1.0)
        return variance

    def put(self, chosen: NDArray[np.intp], newer: _Outcome) -> None:
        """Replace the results for some markers."""
        for part in fields(self):
            getattr(self, part.name)[chosen] = getattr(newer, part.name)


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
        np.stack([guess.lines if guess.lines is not None else _straight(guess.pattern) for guess in guesses]),
    )
    rigidity = np.array([guess.rigidity for guess in guesses])
    settled = np.array([SETTLED if guess.lines is None else NEAR for guess in guesses])
    with np.errstate(all="ignore"):  # a wrong guess may diverge; it is rejected below
        pixels = choose_pixels(image, camera, batch, state.homography)
        visible &= pixels.real.sum(axis=1) >= _PIXELS * _rigid_unknowns(SMOOTH)
        pixel = batch.scale * float(np.max(camera.focal))  # pixels per unit of the scaled rays
        active, coarse = np.flatnonzero(visible), pixels.every(COARSE)
        for _ in range(COARSE_STEPS):
            if active.size <= len(guesses) // _FEW:
                break
            before, part = state.only(active), coarse.only(active)
            moved, _unused = _step(batch.only(active), before, part, SMOOTH)
            state.put(active, moved)
            active = active[_shift(before, moved) * pixel[active] > COARSE_NEAR]
        fits: dict[int, Fit] = {}
        markers = chosen = np.flatnonzero(visible)
        for degree in (SMOOTH, LOCAL):
            if not chosen.size:
                break
            batch, state, pixels = batch.only(chosen), state.only(chosen), pixels.only(chosen)
            pixel, rigidity, settled = pixel[chosen], rigidity[chosen], settled[chosen]
            rests, outcome = _settle(batch, state, pixels, rigidity, pixel, settled, degree)
            good = zip(markers.tolist(), _fits(batch, state, pixels, outcome, rigidity))
            fits |= {marker: fit for (marker, fit), rest in zip(good, rests.tolist()) if fit and rest}
            if degree == SMOOTH:
                chosen = np.flatnonzero(rests & _is_local(pixels, outcome))
                markers = markers[chosen]
    return [fits.get(k) for k in range(len(guesses))]


def _settle(
    batch: MarkerBatch, state: _State, pixels: Pixels, rigidity: Floats, pixel: Floats, settled: Floats, degree: int
) -> tuple[NDArray[np.bool_], _Outcome]:
    """Make steps with all pixels until all markers rest. Changes `state` and `rigidity`.

    `pixel` (K,) is the number of pixels per unit of the scaled rays, and `settled` (K,) the motion in pixels per step
    below which a marker rests. Returns a mask (K,) of the markers that did not diverge, and their last steps.
    """
    shift, active = np.full(len(pixel), np.inf), np.arange(len(pixel))
    for _ in range(FINE_STEPS):
        before, known = state.only(active), rigidity[active]
        moved, newer = _step(batch.only(active), before, pixels.only(active), degree, known)
        if active.size == pixel.size:
            outcome = newer
        else:
            outcome.put(active, newer)
        state.put(active, moved)
        earlier, shift[active] = shift[active], _shift(before, moved) * pixel[active]
        rigidity[active] = np.where(shift[active] < NEAR, _rigidity(newer, before.lines), known)
        loosened = (known == RIGID) & (rigidity[active] < RIGID)
        # Pixels at the limit of outliers, or at that of the blur, can keep a fit from coming to rest.
        resting = (shift[active] <= settled[active]) | ((shift[active] < NEAR) & (shift[active] > earlier / 2))
        active = active[~resting | loosened]
        if not active.size:
            break
    return shift < UNSETTLED, outcome


def _is_local(pixels: Pixels, outcome: _Outcome) -> NDArray[np.bool_]:
    """Return a mask (K,) of the markers whose residuals vary smoothly over the marker, as light does.

    A polynomial of the degree `LOCAL` is fitted to the residuals; with a light of degree `SMOOTH` alone, the part that
    it explains is chi squared.
    """
    terms = _terms(outcome.terms[:, 1:3], LOCAL)[:, outcome.terms.shape[1] :]
    right = (terms @ outcome.left[:, :, None]).astype(float)
    weighted = terms * outcome.weights[:, None]
    solution = _solve((weighted @ terms.transpose(0, 2, 1)).astype(float), right)
    enough = pixels.real.sum(axis=1) >= _PIXELS * _rigid_unknowns(LOCAL)
    explained = np.einsum("kt,kt->k", solution, right[..., 0]) / outcome.variance()
    local: NDArray[np.bool_] = enough & (explained > gate_limit(terms.shape[1]))
    return local


def _terms_count(degree: int) -> int:
    return (degree + 1) * (degree + 2) // 2


def _rigid_unknowns(degree: int) -> int:
    """Return the number of unknowns of a fit without the offsets of inner lines."""
    return _GEOMETRY + 2 * _terms_count(degree) + 1


def _terms(square: Floats, degree: int) -> Floats:
    """Return the terms (K, T, N) of a polynomial of u and v at points (K, 2, N), those of low degrees first."""
    u, v = square[:, 0], square[:, 1]
    terms = last = [np.ones_like(u)]
    for _ in range(degree):
        last = [*(term * u for term in last), last[-1] * v]
        terms = terms + last
    return np.stack(terms, axis=1)


def _straight(pattern: Pattern) -> Floats:
    """Return the offsets (2, n - 1) of inner lines that are where they should be."""
    return np.zeros((2, pattern.modules - 1))


def _step(
    batch: MarkerBatch, state: _State, pixels: Pixels, degree: int, rigidity: Floats | None = None
) -> tuple[_State, _Outcome]:
    """Make one Gauss-Newton step for all markers, in which outliers have no weight; return the new state.

    `degree` is that of the light's polynomials. With `rigidity` (K,), the inner lines between modules may move. It is
    the precision with which they are known to be where they should be, relative to that of a pixel.
    """
    design = _design(batch, state, pixels, degree, with_lines=rigidity is not None)
    rigid = _rigid_unknowns(degree)
    light, residuals, known = _lit(design[:, _GEOMETRY:rigid], pixels)
    count = _terms_count(degree)
    terms = design[:, _GEOMETRY : _GEOMETRY + count].copy()
    weights = _weights(residuals, known)
    roots = np.sqrt(weights)[:, None]
    contrast = light[:, None, count:-1] @ terms * roots
    # Variable projection: the light is solved linearly first, then all unknowns take one step together.
    design[:, :_GEOMETRY] *= contrast
    design[:, _GEOMETRY:rigid] *= roots
    design[:, rigid:] *= contrast
    missed = residuals * roots[:, 0]
    normal = _summed(design, design).astype(float)  # faster if both factors are the same array
    right = np.einsum("kun,kn->ku", design, missed)[..., None].astype(float)
    held, towards = normal, right
    if rigidity is not None:
        held, towards = normal.copy(), right.copy()
        free = np.arange(rigid, normal.shape[1])
        held[:, free, free] += rigidity[:, None]
        towards[:, free, 0] -= rigidity[:, None] * state.lines.reshape(len(normal), -1)
    change = _solve(held, towards)
    left = roots[:, 0] * (missed - np.einsum("ku,kun->kn", change.astype(np.float32), design))
    homography = state.homography.copy()
    homography.reshape(-1, 9)[:, :8] += change[:, :8]
    blur = _possible(state.blur + change[:, [8, 9, 9, 10]].reshape(-1, 2, 2))
    lines = state.lines + change[:, rigid:].reshape(state.lines.shape) if rigidity is not None else state.lines
    outcome = _Outcome(normal, right[..., 0], terms, light[:, count], residuals, weights, left)
    return _State(homography, blur, lines), outcome


def _lit(light: Floats, pixels: Pixels) -> tuple[Floats, Floats, Floats]:
    """Solve for the light, given its derivatives (K, L, N).

    Returns the coefficients (K, L), the residuals (K, N), and the weights (K, N) of the pixels that tell something: 0
    for padding, and for pixels that are as bright as an image can be and that should be brighter.
    """
    clipped, known = pixels.grey >= _CLIPPED, pixels.real
    if clipped.any():
        _, residuals = _level(light, pixels.grey, light * (pixels.real * ~clipped)[:, None])
        known = known * ~(clipped & (residuals < 0))
        level, residuals = _level(light, pixels.grey, light * known[:, None])
        known = pixels.real * ~(clipped & (residuals < 0))
    else:
        level, residuals = _level(light, pixels.grey, light)
    return level, residuals * known, known


def _level(light: Floats, grey: Floats, used: Floats) -> tuple[Floats, Floats]:
    """Return the coefficients (K, L) of the light that fits grey values (K, N), and the residuals (K, N).

    `used` (K, L, N) is `light` with 0 for the pixels that do not count.
    """
    normal, right = _summed(used, light), np.einsum("kln,kn->kl", used, grey)[..., None]
    level = _solve(normal.astype(float), right.astype(float)).astype(np.float32)
    return level, grey - (level[:, None] @ light)[:, 0]


def _possible(blur: Floats) -> Floats:
    """Return the covariances (K, 2, 2) of blurs with their standard deviations limited to `BLURS`."""
    variances, axes = np.linalg.eigh(np.where(np.isfinite(blur), blur, np.eye(2)))
    variances = np.clip(variances, BLURS[0] ** 2, BLURS[1] ** 2)
    possible: Floats = (axes * variances[:, None]) @ np.swapaxes(axes, 1, 2)
    return possible


def _rigidity(outcome: _Outcome, lines: Floats) -> Floats:
    """Return the precision (K,) with which inner lines are where they should be, relative to that of a pixel.

    `outcome` is a step from the offsets `lines` (K, 2, n - 2). It is linear in the unknowns, so the offsets that the
    lines would have if nothing held them can be computed from it. Prints that were rastered have misplaced inner
    lines, and so has bent paper; the outer edges are then the only ones that determine the marker. The variance of the
    offsets is estimated with the method of DerSimonian and Laird (1986).
    """
    rigid, normal = outcome.rigid, _regular(outcome.normal)
    # The other unknowns are eliminated first (Schur complement).
    by_lines = np.concatenate([normal[:, :, rigid:], outcome.right[:, :, None]], axis=2)
    by_lines[:, rigid:] -= normal[:, rigid:, :rigid] @ np.linalg.solve(normal[:, :rigid, :rigid], by_lines[:, :rigid])
    inverse = np.linalg.inv(by_lines[:, rigid:, :-1])
    offsets = lines.reshape(len(lines), -1) + (inverse @ by_lines[:, rigid:, -1:])[..., 0]
    variance = outcome.variance()
    precision = 1 / np.maximum(inverse.diagonal(axis1=1, axis2=2), 1e-12) / variance[:, None]
    chi2 = (offsets**2 * precision).sum(axis=1)
    excess = (chi2 - len(inverse[0])) / precision.sum(axis=1)
    return np.where(chi2 > gate_limit(len(inverse[0])), variance / np.maximum(excess, 1e-12), RIGID)


def _shift(before: _State, after: _State) -> Floats:
    """Return the largest motion (K,) of a corner of each marker between two states, in units of the scaled rays."""
    places = [lifted[:, :2] / lifted[:, 2:] for lifted in (before.homography @ LIFTED, after.homography @ LIFTED)]
    distance: Floats = np.hypot(*(places[1] - places[0]).transpose(1, 0, 2)).max(axis=1)
    return distance


def _squares(values: Floats) -> Floats:
    total: Floats = np.einsum("kn,kn->k", values, values)
    return total


def _summed(left: Floats, right: Floats) -> Floats:
    """Return the sums (K, A, B) over the pixels of the products of values (K, A, N) and (K, B, N)."""
    block = _UNTHREADED // (left.shape[1] * right.shape[1])
    blocks = (slice(first, first + block) for first in range(0, left.shape[2], block))
    sums: Floats = sum(left[..., block] @ right[..., block].transpose(0, 2, 1) for block in blocks)
    return sums


def _solve(normal: Floats, right: Floats) -> Floats:
    """Return the solutions (K, n) of K systems of normal equations: matrices (K, n, n), right sides (K, n, 1)."""
    return np.linalg.solve(_regular(normal), right)[..., 0]


def _regular(normal: Floats) -> Floats:
    """Return normal matrices (K, n, n) that can be inverted, for the sake of the other markers."""
    usable = np.isfinite(normal).all(axis=(1, 2), keepdims=True)
    regular = np.where(usable, normal, np.eye(normal.shape[1]))
    diagonal = np.einsum("kii->ki", regular)
    diagonal += _RIDGE * (diagonal + 1)
    return regular


def _weights(residuals: Floats, real: Floats) -> Floats:
    """Return the weights (K, N) of pixels: 0 for outliers and padding, 1 for most others."""
    sizes = np.abs(residuals)
    count = real.sum(axis=1).astype(np.intp)
    middle = np.minimum(real.shape[1] - count + count // 2, real.shape[1] - 1)  # padding sorts first
    medians = np.partition(sizes - (1 - real), np.unique(middle), axis=1)[np.arange(len(sizes)), middle]
    sigma = _MAD_TO_SIGMA * medians + _ROUNDING
    full, none = OUTLIERS
    weights: Floats = real * np.clip((none - sizes / sigma[:, None]) / (none - full), 0, 1)
    return weights


def _design(batch: MarkerBatch, state: _State, pixels: Pixels, degree: int, *, with_lines: bool) -> Floats:
    """Return the derivatives (K, U, N) of the model; those of the light are 0 for padding.

    They are with respect to 8 elements of the homography, 3 of the blur, the coefficients of the light, and the offsets
    of the inner lines if `with_lines` is true. All but those of the light are for a contrast of 1. If the homography
    moves while the pixel stays, the pixel sees the pattern move in the opposite direction.
    """
    # single precision is twice as fast; the normal equations are solved in double precision
    square, by_point = apply_with_derivative(np.linalg.inv(state.homography).astype(np.float32), pixels.points)
    by_pixel = product(by_point, pixels.by_pixel) * batch.half
    places = square * batch.half + batch.half
    blur = state.blur.astype(np.float32)
    predicted = predict_grey(batch.differences, places, by_pixel, blur, state.lines, with_lines=with_lines)
    w = (state.homography[:, 2:, :2].astype(np.float32) @ square)[:, 0] + 1
    by_place = predicted.by_u[:, None] * by_point[:, 0] + predicted.by_v[:, None] * by_point[:, 1]
    by_place *= (-batch.half / w)[:, None]
    rigid, white = _rigid_unknowns(degree), _GEOMETRY + _terms_count(degree)
    design = np.empty((len(square), rigid + predicted.by_lines.shape[1], square.shape[2]), np.float32)
    design[:, 0:2] = by_place[:, :1] * square
    design[:, 2] = by_place[:, 0]
    design[:, 3:5] = by_place[:, 1:] * square
    design[:, 5] = by_place[:, 1]
    design[:, 6:8] = -(by_place * pixels.points).sum(axis=1)[:, None] * square
    design[:, 8:11] = predicted.by_blur
    design[:, _GEOMETRY:white] = _terms(square, degree) * pixels.real[:, None]
    design[:, white : rigid - 1] = predicted.grey[:, None] * design[:, _GEOMETRY:white]
    design[:, rigid - 1] = predicted.by_growth * pixels.real
    design[:, rigid:] = predicted.by_lines
    return design


def _fits(batch: MarkerBatch, state: _State, pixels: Pixels, outcome: _Outcome, rigidity: Floats) -> list[Fit | None]:
    """Return the results of the fit, given the last steps; None for a marker whose covariance is not finite."""
    normal = outcome.normal.copy()
    free = np.arange(outcome.rigid, normal.shape[1])
    normal[:, free, free] += rigidity[:, None]
    usable = np.isfinite(normal).all(axis=(1, 2))
    variance = outcome.variance()
    homography = np.broadcast_to(np.eye(normal.shape[1], 8), (*normal.shape[:2], 8))
    by_unknowns = np.linalg.solve(_regular(normal), homography)[:, :8] * variance[:, None, None]
    corners, by_homography = _corners(state.homography)
    scale = batch.scale[:, None, None]
    covariance = by_homography @ by_unknowns @ np.swapaxes(by_homography, 1, 2) * scale**2
    usable &= np.isfinite(covariance).all(axis=(1, 2)) & np.isfinite(corners).all(axis=(1, 2))
    rays = corners * scale + batch.centre[:, None]
    count = np.maximum(pixels.real.sum(axis=1), 1)
    spread = (pixels.grey - (pixels.grey.sum(axis=1) / count)[:, None]) * pixels.real
    explained = 1 - _squares(outcome.residuals) / np.maximum(_squares(spread), 1e-9)
    blur = np.linalg.det(state.blur) ** 0.25
    return [
        (
            Fit(
                rays=rays[k],
                covariance=covariance[k],
                noise=math.sqrt(float(variance[k])),
                contrast=float(outcome.contrast[k]),
                explained=float(explained[k]),
                blur=float(blur[k]),
                lines=state.lines[k],
                rigidity=float(rigidity[k]),
            )
            if usable[k]
            else None
        )
        for k in range(len(rays))
    ]


def _corners(homography: Floats) -> tuple[Floats, Floats]:
    """Return the corners (K, 4, 2) of markers as scaled rays, and their derivative (K, 8, 8).

    The derivative is with respect to the elements of the homographies (K, 3, 3), of which only the first eight vary.
    """
    lifted = homography @ LIFTED
    corners = np.swapaxes(lifted[:, :2] / lifted[:, 2:], 1, 2)
    place = np.swapaxes(LIFTED / lifted[:, 2:], 1, 2)
    derivative = np.zeros((len(homography), 4, 2, 8))
    derivative[:, :, 0, :3] = derivative[:, :, 1, 3:6] = place
    derivative[..., 6:] = -corners[..., None] * place[:, :, None, :2]
    return corners, derivative.reshape(-1, 8, 8)
