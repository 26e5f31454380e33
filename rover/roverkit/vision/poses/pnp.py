"""Perspective-n-point: computes the pose of a marker or board from its corners.

A flat marker has two possible poses; both are computed, with covariances. Corners are given as rays (points in the
plane z = 1), so no model of the lens is needed here. A landmark is a marker or a board.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roverkit.gating import gate_limit
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.markers.marker_set import square
from roverkit.vision.opencv import cv2
from roverkit.vision.poses.pose import Pose, predict_all, rotation_of

# cv2.solvePnP gives no covariance, takes no weights, and IPPE needs all corners in one plane, which a board's markers
# may not be. From the same corners of single markers, OpenCV's refinement is nearly as good: the median error of the
# translation on 30 clean frames is 0.030 percent at 24 px (OpenCV 0.033) and 0.005 at 96 px (0.005). The derivatives of
# this refinement are needed for the covariance in any case.
STEPS = 30
WORST_START = 1000.0
"""Ratio of chi squared of a start pose to that of the best start pose, above which the pose is not refined.

IPPE's solutions are nearly minima, so a start pose with a much worse fit stays worse.
"""
_CONVERGED = 1e-3
"""Relative change of chi squared below which a refinement ends."""
_SAME = np.radians(0.05)
"""Angle in radians below which two solutions count as one."""
_MOST_DAMPED = 1e6


@dataclass(frozen=True, slots=True, eq=False)
class Corners:
    """Observed corners of a landmark: points (N, 3) in the landmark's frame, in metres, and their rays (N, 2).

    A ray is a point (x, y) in the plane z = 1.
    """

    points: Floats
    rays: Floats
    covariance: Floats
    """Covariance (2N, 2N) of the rays due to the noise of the image."""
    own: Floats | None = None
    """Covariance (2N, 2N) due to other errors that only this landmark has, such as bent paper."""
    shared: Floats | None = None
    """Shifts (2N, S) of the rays by one standard deviation of each error that all landmarks of the image have."""

    @property
    def own_covariance(self) -> Floats:
        """Covariance (2N, 2N) of the rays due to all errors that only this landmark has."""
        return self.covariance if self.own is None else self.covariance + self.own

    @property
    def shifts(self) -> Floats:
        """Shifts (2N, S) as in `shared`; without columns if no error is shared."""
        return np.empty((self.rays.size, 0)) if self.shared is None else self.shared


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """Possible pose of a landmark (landmark to camera): a local optimum of the fit."""

    pose: Pose
    covariance: Floats
    """Covariance (6, 6) of the pose: x y z in metres, rotX rotY rotZ in radians."""
    chi2: float
    """Sum of squared residuals in standard deviations; about 2N - 6 if all assumptions hold."""
    error: float
    """Root mean square distance between corners and their projections, in the plane z = 1."""


def square_poses(points: Floats, rays: Floats) -> list[list[Pose]]:
    """Return both possible poses of each of K markers, given their corners (K, 4, 3) and rays (K, 4, 2).

    The corners are in the frame of the landmark (marker or board), in which a marker may lie anywhere. Uses IPPE
    (Collins and Bartoli, 2014) from OpenCV.
    """
    right, up = points[:, 1] - points[:, 0], points[:, 0] - points[:, 3]
    sides = np.sqrt((right * right).sum(axis=1))
    right, up = right / sides[:, None], up / sides[:, None]
    to_marker = np.stack([right, up, np.cross(right, up)], axis=1)
    middles = points.mean(axis=1)
    found = [_ippe(float(side), own) for side, own in zip(sides, rays)]
    owners = [owner for owner, solutions in enumerate(found) for _ in solutions]
    turns, shifts = (
        np.array([solution for solutions in found for solution in solutions]).reshape(-1, 2, 3).swapaxes(0, 1)
    )
    rotations = rotation_of(turns) @ to_marker[owners]
    translations = shifts - (rotations @ middles[owners][..., None])[..., 0]
    usable = np.isfinite(rotations).all(axis=(1, 2)) & (shifts[:, 2] > 0)
    poses: list[list[Pose]] = [[] for _ in found]
    for index in np.flatnonzero(usable):
        poses[owners[index]].append(Pose(rotations[index], translations[index]))
    return poses


def _ippe(side: float, rays: Floats) -> list[tuple[Floats, Floats]]:
    """Return the rotation vectors (3,) and translations (3,) of a marker's possible poses (marker to camera).

    The frame of the marker has its origin in the marker's centre, x to the right and y up.
    """
    _, turns, shifts, _ = cv2.solvePnPGeneric(
        square(side), rays.reshape(4, 1, 2), np.eye(3), None, flags=cv2.SOLVEPNP_IPPE_SQUARE
    )
    return [(turn.ravel(), shift.ravel()) for turn, shift in zip(turns, shifts)]


def solve(seen: Sequence[Corners], starts: Sequence[Sequence[Pose]]) -> list[list[Solution]]:
    """Refine the start poses of each landmark; return the distinct solutions of each landmark, the best first.

    Landmarks with the same number of corners are refined together, because numpy is slow on small arrays.
    """
    found: list[list[Solution]] = [[] for _ in seen]
    by_count: dict[int, list[int]] = {}
    for owner, corners in enumerate(seen):
        by_count.setdefault(len(corners.points), []).append(owner)
    for owners in by_count.values():
        whitening = _whitening(np.stack([seen[owner].covariance for owner in owners]))
        group = [
            _Start(owner, seen[owner], its_whitening, pose)
            for owner, its_whitening in zip(owners, whitening)
            for pose in starts[owner]
            if np.isfinite(its_whitening).all()
        ]
        for start, solution in zip(group, _solutions(group)):
            if solution:
                found[start.owner].append(solution)
    return [_different(solutions) for solutions in found]


class _Start(NamedTuple):
    """Start pose of a landmark, with the corners to which it is fitted."""

    owner: int
    """Index of the landmark."""
    corners: Corners
    whitening: Floats
    pose: Pose


def _whitening(covariance: Floats) -> Floats:
    """Return the matrices (P, 2N, 2N) that make errors with covariances (P, 2N, 2N) independent with variance 1.

    A matrix is NaN if the covariance is not positive definite: two corners are at one place, or not finite.
    """
    try:
        return np.linalg.inv(np.linalg.cholesky(covariance))
    except np.linalg.LinAlgError:
        if len(covariance) == 1:
            return np.full_like(covariance, np.nan)
        return np.concatenate([_whitening(one[None]) for one in covariance])


def _different(solutions: list[Solution]) -> list[Solution]:
    """Return the solutions, best first, without those whose pose equals the pose of a better one."""
    kept: list[Solution] = []
    for solution in sorted(solutions, key=lambda solution: solution.chi2):
        if all(solution.pose.angle_to(other.pose) > _SAME for other in kept):
            kept.append(solution)
    return kept


class _Problem:
    """Fit of P poses to corners; the arrays have the shape (P, N, ...) for N corners each."""

    def __init__(self, starts: Sequence[_Start]) -> None:
        self.owners = np.array([start.owner for start in starts])
        self.points = np.stack([start.corners.points for start in starts])
        self.rays = np.stack([start.corners.rays for start in starts])
        self.whitening = np.stack([start.whitening for start in starts])

    def at(self, rotation: Floats, translation: Floats) -> _Places:
        """Return P poses with the residuals of their corners and the derivatives of the predicted rays."""
        rays, derivative = predict_all(rotation, translation, self.points)
        missed = self.rays - rays
        count = len(missed)
        residuals = (self.whitening @ missed.reshape(count, -1, 1))[..., 0]
        derivative = self.whitening @ derivative.reshape(count, -1, 6)
        return _Places(rotation, translation, missed, residuals, derivative, (residuals**2).sum(axis=1))


@dataclass(frozen=True, slots=True, eq=False)
class _Places:
    """P poses with their residuals and derivatives."""

    rotation: Floats
    """Rotation matrices (P, 3, 3)."""
    translation: Floats
    """Translations (P, 3) in metres."""
    missed: Floats
    """Differences (P, N, 2) between the rays and their predictions."""
    residuals: Floats
    """Residuals (P, 2N) in standard deviations."""
    derivative: Floats
    """Derivative (P, 2N, 6) of the predicted rays with respect to the pose, in standard deviations."""
    chi2: Floats
    """Sum of the squared residuals (P,)."""

    def normal(self) -> Floats:
        """Return the normal matrix (6, 6) of each pose, as an array (P, 6, 6)."""
        matrices: Floats = np.swapaxes(self.derivative, 1, 2) @ self.derivative
        return matrices

    def where(self, chosen: NDArray[np.bool_], other: _Places) -> _Places:
        """Return new poses: those of this object where `chosen` is true, and those of `other` elsewhere."""
        pairs = ((getattr(self, part.name), getattr(other, part.name)) for part in fields(self))
        return _Places(*(np.where(chosen.reshape(-1, *[1] * (own.ndim - 1)), own, theirs) for own, theirs in pairs))


def _solutions(starts: Sequence[_Start]) -> list[Solution | None]:
    """Refine start poses whose landmarks have the same number of corners; return one solution for each start pose.

    A result is None if the corners do not determine the pose.
    """
    if not starts:
        return []
    problem = _Problem(starts)
    with np.errstate(all="ignore"):  # poses behind the camera, or that diverge
        places = problem.at(
            np.stack([start.pose.rotation for start in starts]), np.stack([start.pose.translation for start in starts])
        )
        least = np.full(problem.owners.max() + 1, np.inf)
        np.fmin.at(least, problem.owners, places.chi2)
        places = _refine(problem, places, places.chi2 < WORST_START * (1 + least[problem.owners]))
        normal = places.normal()
        usable = _invertible(normal)
        covariance = np.linalg.inv(np.where(usable[:, None, None], normal, np.eye(6)))
    # A nearly singular matrix can have an inverse with negative variances.
    usable &= covariance.diagonal(axis1=1, axis2=2).min(axis=1) > 0
    covariance = (covariance + np.swapaxes(covariance, 1, 2)) / 2
    error = np.sqrt((places.missed**2).sum(axis=2).mean(axis=1))
    return [
        (
            Solution(
                Pose(places.rotation[k], places.translation[k]), covariance[k], float(places.chi2[k]), float(error[k])
            )
            if usable[k]
            else None
        )
        for k in range(len(starts))
    ]


def _refine(problem: _Problem, places: _Places, moving: NDArray[np.bool_]) -> _Places:
    """Refine those poses for which `moving` is true, by the Levenberg-Marquardt algorithm."""
    damping: Floats = np.full(len(moving), 1e-4)
    for _ in range(STEPS):
        normal = places.normal()
        moving = moving & _invertible(normal)
        if not moving.any():
            break
        normal[:, range(6), range(6)] *= 1 + damping[:, None]
        normal[~moving] = np.eye(6)
        change = np.linalg.solve(normal, np.swapaxes(places.derivative, 1, 2) @ places.residuals[..., None])[..., 0]
        moved = problem.at(rotation_of(change[:, 3:]) @ places.rotation, places.translation + change[:, :3])
        better = moving & (moved.chi2 <= places.chi2)  # false for NaN
        gain = places.chi2 - moved.chi2
        goes_on = np.where(better, gain >= _CONVERGED * (0.1 + moved.chi2), damping <= _MOST_DAMPED)
        moving = moving & goes_on
        damping = np.where(better, damping / 10, damping * 10)
        places = moved.where(better, places)
    return places


def _invertible(matrices: Floats) -> NDArray[np.bool_]:
    """Return a mask (P,) of the matrices (P, n, n) that are invertible. A matrix with NaN is not."""
    invertible: NDArray[np.bool_] = np.isfinite(matrices).all(axis=(1, 2)) & (np.linalg.det(matrices) > 0)
    return invertible


def with_all_errors(
    seen: Sequence[Corners], found: Sequence[Sequence[Solution]], side_sigma: float = 0.0
) -> list[tuple[Corners, list[Solution]]]:
    """Return the corners of each landmark and its solutions, with covariances that contain all errors of the corners.

    The poses were fitted to the noise of the image alone. Their covariances become larger if the best chi squared is
    larger than chance explains: then there are errors that no covariance contains. `side_sigma` is the standard
    deviation of the size of all landmarks, as a fraction. The solutions are returned best fit first, by all errors.
    """
    results: dict[int, tuple[Corners, list[Solution]]] = {}
    groups: dict[int, list[int]] = {}
    for owner, corners in enumerate(seen):
        groups.setdefault(len(corners.points), []).append(owner)
    for owners in groups.values():
        # Those with the same number of corners together, because numpy is slow on small arrays.
        rows = [(owner, solution) for owner in owners for solution in found[owner]]
        rotation = np.stack([solution.pose.rotation for _, solution in rows])
        points = np.stack([seen[owner].points for owner, _ in rows])
        rays, derivative = predict_all(rotation, np.stack([solution.pose.translation for _, solution in rows]), points)
        larger = (derivative[..., :3] @ (points @ np.swapaxes(rotation, 1, 2))[..., None]).reshape(len(rows), -1, 1)
        firsts = [next(row for row, (other, _) in enumerate(rows) if other == owner) for owner in owners]
        shifts = dict(zip(owners, side_sigma * larger[firsts]))
        shared = {owner: np.concatenate([seen[owner].shifts, shifts[owner]], axis=1) for owner in owners}
        whole = np.stack([seen[owner].own_covariance + shared[owner] @ shared[owner].T for owner, _ in rows])
        by_pose = derivative.reshape(len(rows), -1, 6)
        weighed = np.swapaxes(by_pose, 1, 2) @ np.linalg.inv(whole)
        missed = np.stack([seen[owner].rays for owner, _ in rows]).reshape(len(rows), -1, 1) - rays.reshape(
            len(rows), -1, 1
        )
        # chi squared of the pose that fits best if all errors are considered, near the pose
        left = missed - by_pose @ np.linalg.solve(weighed @ by_pose, weighed @ missed)
        chi2 = (left * np.linalg.solve(whole, left)).sum(axis=(1, 2))
        image = np.stack([seen[owner].covariance for owner, _ in rows])
        alone = np.stack([solution.covariance for _, solution in rows])
        gain = alone @ np.swapaxes(np.linalg.solve(image, by_pose), 1, 2)
        covariance = gain @ whole @ np.swapaxes(gain, 1, 2)
        covariance = (covariance + np.swapaxes(covariance, 1, 2)) / 2
        for owner in owners:
            mine = [row for row, (other, _) in enumerate(rows) if other == owner]
            factor = _excess(float(np.min(chi2[mine])), seen[owner])
            known = [
                Solution(rows[row][1].pose, factor * covariance[row], float(chi2[row]) / factor, rows[row][1].error)
                for row in mine
            ]
            corners, own = seen[owner], seen[owner].own
            wider = Corners(
                corners.points,
                corners.rays,
                corners.covariance * factor,
                None if own is None else own * factor,
                shared[owner] * factor**0.5,
            )
            results[owner] = wider, sorted(known, key=lambda solution: solution.chi2)
    return [results[owner] for owner in range(len(seen))]


def mixed_covariance(pose: Pose, possible: Sequence[tuple[float, Pose, Floats]]) -> Floats:
    """Return the covariance (6, 6) of the error of `pose`, if the true pose is one of several.

    Each possible pose has its probability, and its own covariance (6, 6).
    """
    whole = np.zeros((6, 6))
    for probability, other, covariance in possible:
        whole += probability * covariance
        if other is not pose:
            change = pose.change_to(other)
            whole += probability * np.outer(change, change)
    return whole


def _excess(chi2: float, corners: Corners) -> float:
    """Return the factor by which covariances are too small; 1 if chi squared can be chance."""
    freedom = corners.rays.size - 6
    return chi2 / freedom if chi2 > gate_limit(freedom) else 1.0
