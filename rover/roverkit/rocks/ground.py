"""Fit of the ground's plane to points of a depth image, by RANSAC and SVD.

A plane is a linear function of the ray in inverse depth: with the point z (x, y, 1), the equation n . point = d becomes
1 / z = (n / d) . (x, y, 1). The noise of a stereo camera's disparity, and so that of the inverse depth, is the same at
all distances. In a linear fit of the inverse depth, all points therefore have the same weight.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roverkit.vision.camera.camera_model import Floats

NOISE = 0.0042
"""Standard deviation of the inverse depth in 1/m: 0.08 px of disparity of a D435i with 640 columns."""
_SEED = 7
_TRIALS = 300
"""Random planes through three points each. If half of the points are on the ground, each trial hits it with 12 %."""
_JUDGED = 600
"""Number of points with which the trials are judged."""
_ROUGH_M = 0.008
"""Distance from the plane in metres up to which points fit: the ground is rough."""
_REFINEMENTS = 4


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """Plane of the ground in the camera's optical frame: the points with ``normal @ point + height == 0``."""

    normal: Floats
    """Unit vector (3,) that points to the side of the camera."""
    height: float
    """Height of the camera above the plane in metres."""
    share: float
    """Share of the points that fit the plane."""

    def meet(self, directions: Floats) -> Floats:
        """Return the points (..., 3) where rays with these directions (..., 3) meet the ground; NaN if they do not."""
        slope = directions @ self.normal
        with np.errstate(divide="ignore", invalid="ignore"):
            points: Floats = directions * np.where(slope < 0, -self.height / slope, np.nan)[..., None]
        return points


def fit_ground(directions: Floats, depth: Floats) -> Ground | None:
    """Return the plane on which most points lie; None if the points determine none.

    ``directions`` (N, 3) are the points (x, y, 1) of the rays, and ``depth`` (N,) is in metres. Equal points give equal
    results: the random numbers have a fixed seed.
    """
    inverse = 1 / depth
    plane = _best_trial(directions, inverse)
    for _ in range(_REFINEMENTS):
        if plane is None:
            return None
        near = _fits(plane[None], directions, inverse)[0]
        plane, _, rank, _ = np.linalg.lstsq(directions[near], inverse[near], rcond=1e-6)  # by SVD
        if rank < 3:
            return None
    if plane is None:
        return None
    size = float(np.linalg.norm(plane))
    # 1 / z = -(normal / height) . (x, y, 1), and the camera is above the plane.
    return Ground(-plane / size, 1 / size, float(_fits(plane[None], directions, inverse).mean()))


def _best_trial(directions: Floats, inverse: Floats) -> Floats | None:
    """Return the coefficients (3,) of the plane that most points fit, of random planes through three points each."""
    if len(directions) < 3:
        return None
    rng = np.random.default_rng(_SEED)
    chosen = rng.integers(len(directions), size=(_TRIALS, 3))
    systems = directions[chosen]
    regular = np.abs(np.linalg.det(systems)) > 1e-12
    if not regular.any():
        return None
    planes = np.linalg.solve(systems[regular], inverse[chosen[regular]][..., None])[..., 0]
    judged = rng.permutation(len(directions))[:_JUDGED]
    counts = np.count_nonzero(_fits(planes, directions[judged], inverse[judged]), axis=1)
    best: Floats = planes[int(np.argmax(counts))]
    return best


def _fits(planes: Floats, directions: Floats, inverse: Floats) -> NDArray[np.bool_]:
    """Return (M, N) which of N points fit which of M planes: by the noise of their depth, or by their distance."""
    off = np.abs(planes @ directions.T - inverse)
    # The distance from the plane is the error of the inverse depth, times the depth, divided by |plane|.
    distances = off / inverse / np.maximum(np.linalg.norm(planes, axis=1), 1e-9)[:, None]
    fits: NDArray[np.bool_] = (off <= 3 * NOISE) | (distances <= _ROUGH_M)
    return fits
