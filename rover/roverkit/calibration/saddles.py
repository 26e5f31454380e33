"""Sub-pixel positions of chessboard corners, fitted to the grey values of all pixels near them.

At such a corner two edges cross, and the grey values form a saddle. The grey values near it are modelled as four
quadrants, two black and two white, blurred, with a linear gradient of brightness. Position, directions of the edges,
blur and brightness are fitted together by the Gauss-Newton method; the quality of the fit gives the uncertainty. All
corners of an image are fitted at once: K corners with N pixels each.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.markers.detection import Image
from roverkit.vision.markers.pattern import make_pattern, predict_grey

# Why not cv2.cornerSubPix: it takes every gradient in its window for one of the edges through the corner. On a ChArUco
# board, markers stand close to the corners; a larger window, which averages more noise, catches their bits and makes
# the result worse. It also gives no uncertainty. Here the pixels near a marker are left out, and all others are
# compared with a model.
#
# The unknowns of a corner are 9: its position (2), the directions of both edges (2), the blur, and the brightness: a
# level, a gradient (2) and the contrast.
RADIUS = 7
"""Half the side in pixels of the window around a corner; within it, lens distortion does not bend an edge."""
CLEAR = 1.6
"""Smallest distance in pixels between a pixel that is used and the edge of a marker."""
STEPS = 8
SETTLED = 1e-3
"""Motion of a corner in pixels per step below which the fit has converged."""
FARTHEST = 2.0
"""Largest distance in pixels between a fitted corner and its initial position; other fits are rejected."""
FIRST_BLUR = 1.0
BLURS = (0.3, 4.0)
"""Range of the blur's standard deviation in pixels."""
EXPLAINED = 0.9
"""Least share of the variance that the model must explain; below it the corner is absent or partly hidden."""

_FEWEST = 30  # pixels
_UNKNOWNS = 9
_LARGEST_TURN = 0.2
_LARGEST_CHANGE = 0.3
_FAR = 1000.0
"""Side in pixels of the model's squares, so large that the window contains only the two edges through the corner."""
_DIFFERENCES = make_pattern(np.eye(2, dtype=bool)).differences


@dataclass(frozen=True, slots=True, eq=False)
class Sites:
    """Input of `find_saddles`: initial positions of K corners, and the directions of the board's axes in the image."""

    places: Floats
    """Initial positions (K, 2) in pixels."""
    axes: Floats
    """Derivative (K, 2, 2) of the pixel position with respect to the board's x and y, in pixels per metre."""
    gap: float
    """Distance in metres from a corner to the nearest marker, along the board's x or y axis."""
    reach: float
    """Distance in metres from a corner, along its edges, up to which pixels are used."""
    curvatures: Floats | None = None
    """Curvature vectors (K, 2, 2) of the edges in 1/pixel: edge along y, edge along x. None for straight edges."""


@dataclass(frozen=True, slots=True, eq=False)
class Saddles:
    """Results of fitting a saddle surface to the image around each of K corners of a chessboard."""

    places: Floats
    """Fitted positions (K, 2) in pixels."""
    sigmas: Floats
    """Standard deviation (K,) of a coordinate in pixels, from the noise of the grey values."""
    blurs: Floats
    """Standard deviation (K,) of the blur in pixels."""
    found: NDArray[np.bool_]
    """Mask (K,) of the corners that the image shows; where it is false, the other values are meaningless."""


@dataclass(frozen=True, slots=True, eq=False)
class _State:
    places: Floats
    """Positions (K, 2) of the corners in pixels."""
    angles: Floats
    """Directions (K, 2) of the normals of both edges, in radians."""
    log_blurs: Floats
    """Natural logarithms (K,) of the blur's standard deviation in pixels."""


@dataclass(frozen=True, slots=True, eq=False)
class _Outcome:
    covariance: Floats
    """Covariance (K, 2, 2) of the positions of the corners in pixels."""
    explained: Floats
    contrast: Floats


def find_saddles(image: Image, sites: Sites) -> Saddles:
    """Fit the corners of a chessboard in a grey image (H, W); the fits start at the initial positions in `sites`."""
    pixels, real = _pixels(image, sites)
    grey = np.where(real, image[pixels[:, 1], pixels[:, 0]], 0.0)
    normals = np.linalg.inv(sites.axes)  # rows: the derivatives of the board's x and y by the pixels
    state = _State(
        sites.places, np.arctan2(normals[:, :, 1], normals[:, :, 0]), np.full(len(pixels), np.log(FIRST_BLUR))
    )
    curvatures = np.zeros((len(pixels), 2, 2)) if sites.curvatures is None else sites.curvatures
    with np.errstate(all="ignore"):  # without a corner the fit may diverge; `found` is then false
        for _ in range(STEPS):
            before = state
            state, outcome = _step(before, pixels, grey, real, curvatures)
            if np.nanmax(np.abs(state.places - before.places), initial=0.0) < SETTLED:
                break
        moved = np.linalg.norm(state.places - sites.places, axis=1)
        found = (moved < FARTHEST) & (outcome.explained > EXPLAINED) & (real.sum(axis=1) >= _FEWEST)
        sigmas = np.sqrt(np.trace(outcome.covariance, axis1=1, axis2=2) / 2)
        found &= np.isfinite(sigmas)
    return Saddles(state.places, sigmas, np.exp(state.log_blurs), found)


def _pixels(image: Image, sites: Sites) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Return the pixels (K, 2, N) around each corner, and the mask (K, N) of the pixels that the fit can use.

    The fit cannot use pixels of a marker, pixels near other edges, and pixels outside the image.
    """
    side = np.arange(-RADIUS, RADIUS + 1)
    around = np.stack(np.meshgrid(side, side)).reshape(2, -1)
    pixels = np.rint(sites.places).astype(np.intp)[:, :, None] + around
    offsets = pixels - sites.places[:, :, None]
    inverse = np.linalg.inv(sites.axes)
    on_board = np.abs(inverse @ offsets)  # metres along the board's axes
    clear = CLEAR * np.linalg.norm(inverse, axis=2)[:, :, None]  # CLEAR in metres
    in_marker = (on_board > sites.gap - clear).all(axis=1)
    near = (on_board < sites.reach - clear).all(axis=1)
    height, width = image.shape
    inside = ((pixels >= 0) & (pixels < np.array([width, height])[:, None])).all(axis=1)
    round_ = (offsets**2).sum(axis=1) <= RADIUS**2
    return np.where(inside[:, None], pixels, 0), inside & near & ~in_marker & round_


def _step(
    state: _State, pixels: NDArray[np.intp], grey: Floats, real: NDArray[np.bool_], curvatures: Floats
) -> tuple[_State, _Outcome]:
    design, contrast, residuals = _design(state, pixels, grey, real, curvatures)
    normal = design @ design.transpose(0, 2, 1)
    scale = 1 / np.sqrt(np.maximum(np.einsum("kii->ki", normal), 1e-9))
    inverse = np.linalg.inv(normal * scale[:, :, None] * scale[:, None] + 1e-12 * np.eye(_UNKNOWNS))
    inverse *= scale[:, :, None] * scale[:, None]
    change = (inverse @ (design @ residuals[:, :, None]))[..., 0]
    left = residuals - (change[:, None] @ design)[:, 0]
    variance = (left**2).sum(axis=1) / np.maximum(real.sum(axis=1) - _UNKNOWNS, 1)
    mean = grey.sum(axis=1) / np.maximum(real.sum(axis=1), 1)
    spread = ((grey - mean[:, None] * real) ** 2).sum(axis=1)
    # Steps are limited: far from the solution, the linear model of an edge promises too much.
    moved = _State(
        state.places + np.clip(change[:, :2], -1, 1),
        state.angles + np.clip(change[:, 2:4], -_LARGEST_TURN, _LARGEST_TURN),
        np.clip(state.log_blurs + np.clip(change[:, 4], -_LARGEST_CHANGE, _LARGEST_CHANGE), *np.log(BLURS)),
    )
    explained = 1 - (left**2).sum(axis=1) / np.maximum(spread, 1e-9)
    return moved, _Outcome(inverse[:, :2, :2] * variance[:, None, None], explained, contrast)


def _design(
    state: _State, pixels: NDArray[np.intp], grey: Floats, real: NDArray[np.bool_], curvatures: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return the derivatives (K, 9, N) of the model's grey values, the contrast (K,), and the residuals (K, N).

    The derivatives are with respect to position, angles of the edges, logarithm of the blur, and brightness.
    """
    offsets = pixels - state.places[:, :, None]
    normals = np.stack([np.cos(state.angles), np.sin(state.angles)], axis=2)  # (K, edge, 2)
    turned = np.stack([-normals[:, :, 1], normals[:, :, 0]], axis=2) @ offsets
    # A curved edge is approximated by a parabola. The derivatives are those of a straight edge; the difference is tiny.
    distances = normals @ offsets - 0.5 * (curvatures * normals).sum(axis=2)[:, :, None] * turned**2
    count = pixels.shape[2]
    by_pixel = np.broadcast_to((normals / _FAR)[..., None], (len(pixels), 2, 2, count))
    variance = np.exp(2 * state.log_blurs)[:, None, None]
    predicted = predict_grey(
        np.broadcast_to(_DIFFERENCES, (len(pixels), 3, 3)), distances / _FAR + 1, by_pixel, variance * np.eye(2)
    )
    light = np.stack([np.ones_like(grey), offsets[:, 0], offsets[:, 1], predicted.grey], axis=1) * real[:, None]
    # Brightness is linear in the model, so it is solved exactly before each step (variable projection), and needs no
    # start.
    level = np.linalg.solve(light @ light.transpose(0, 2, 1) + 1e-9 * np.eye(4), light @ grey[:, :, None])
    residuals = grey - (level[:, None, :, 0] @ light)[:, 0]
    by_distance = np.stack([predicted.by_u, predicted.by_v], axis=1) / _FAR  # (K, edge, N)
    contrast = level[:, 3]
    by_log_blur = 2 * variance * (predicted.by_blur[:, :1] + predicted.by_blur[:, 2:])
    shape = np.concatenate([-normals.transpose(0, 2, 1) @ by_distance, by_distance * turned, by_log_blur], axis=1)
    return np.concatenate([shape * contrast[:, :, None] * real[:, None], light], axis=1), contrast[:, 0], residuals
