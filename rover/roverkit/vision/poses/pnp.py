"""Perspective-n-point: computes the pose of a marker or board from its corners.

A flat marker has two possible poses; both are computed, with covariances. Corners are given as rays (points in the
plane z = 1), so no model of the lens is needed here. A landmark is a marker or a board.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roverkit.gating import gate_limit
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.poses.homography import apply_with_derivative, homographies
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
    (Collins and Bartoli, 2014): the place and the derivative of the homography at the marker's centre have two poses.
    """
    right, up = points[:, 1] - points[:, 0], points[:, 0] - points[:, 3]
    sides = np.sqrt((right * right).sum(axis=1))[:, None]
    with np.errstate(all="ignore"):  # corners that are no quadrilateral
        centre, derivative = apply_with_derivative(homographies(np.swapaxes(rays, 1, 2)), np.zeros((1, 2, 1)))
        centre, derivative = centre[..., 0], derivative[..., 0] * (1, -1)  # with respect to x right and y up
        owners = np.flatnonzero(np.isfinite(derivative).all(axis=(1, 2)) & (np.linalg.det(derivative) != 0))
    sight = np.ones((len(owners), 2, 3))  # of the centre, and a vector across it
    sight[:, 0, :2] = centre[owners]
    sight[:, 1, 1], sight[:, 1, 2] = 0, -sight[:, 0, 0]
    sight /= np.sqrt((sight * sight).sum(axis=2))[..., None]
    axes = _frames(sight[:, 0], sight[:, 1])
    # Along the line of sight, a marker is shortened in one direction: by the cosine of its tilt.
    left, scales, turn = np.linalg.svd(np.swapaxes(axes[:, :2, 1:], 1, 2) @ derivative[owners])
    cosine = scales[:, 1] / scales[:, 0]
    left[:, :, 1] *= cosine[:, None]
    flat = axes[:, :, 1:] @ left @ turn
    deep = axes[:, :, :1] @ (np.sqrt(1 - cosine**2)[:, None] * turn[:, 1])[:, None]
    along = np.stack([flat + deep, flat - deep])
    to_marker = np.swapaxes(_frames(right / sides, up / sides), 1, 2)
    rotations = _frames(along[..., 0], along[..., 1]) @ to_marker[owners]
    # The translation that brings the corners nearest to their rays, by linear least squares.
    rays = rays[owners]
    turned = points[owners] @ np.swapaxes(rotations, 2, 3)
    missing = rays * turned[..., 2:] - turned[..., :2]
    middle = rays.mean(axis=1)
    apart = rays - middle[:, None]
    depth = -((apart * missing).sum(axis=(2, 3)) / (apart * apart).sum(axis=(1, 2)))[..., None]
    translations = np.concatenate([missing.mean(axis=2) + middle * depth, depth], axis=2)
    poses: list[list[Pose]] = [[] for _ in points]
    for owner, turns, shifts in zip(owners, rotations.swapaxes(0, 1), translations.swapaxes(0, 1)):
        poses[owner] = list(map(Pose, turns, shifts))
    return poses


def _frames(x: Floats, y: Floats) -> Floats:
    """Return the rotations (..., 3, 3) whose columns are x, y (..., 3) and their cross product."""
    # np.cross takes several times as long.
    z = x[..., [1, 2, 0]] * y[..., [2, 0, 1]] - x[..., [2, 0, 1]] * y[..., [1, 2, 0]]
    return np.stack([x, y, z], axis=-1)


class _Group(NamedTuple):
    """G landmarks with the same number N of corners; they are treated together, as numpy is slow on small arrays."""

    owners: Sequence[int]
    """Indices of the landmarks."""
    points: Floats
    """Points (G, N, 3) as in `Corners`."""
    rays: Floats
    covariance: Floats


def _groups(seen: Sequence[Corners]) -> Iterator[_Group]:
    by_count: dict[int, list[int]] = {}
    for owner, corners in enumerate(seen):
        by_count.setdefault(len(corners.points), []).append(owner)
    for owners in by_count.values():
        group = [seen[owner] for owner in owners]
        yield _Group(
            owners,
            np.array([corners.points for corners in group]),
            np.array([corners.rays for corners in group]),
            np.array([corners.covariance for corners in group]),
        )


def solve(seen: Sequence[Corners], starts: Sequence[Sequence[Pose]]) -> list[list[Solution]]:
    """Refine the start poses of each landmark; return the distinct solutions of each landmark, the best first."""
    found: list[list[Solution]] = [[] for _ in seen]
    for group in _groups(seen):
        whitening = _whitening(group.covariance)
        usable = np.isfinite(whitening).all(axis=(1, 2)).tolist()
        rows = [(place, pose) for place, owner in enumerate(group.owners) if usable[place] for pose in starts[owner]]
        if not rows:
            continue
        places = np.array([place for place, _ in rows])
        problem = _Problem(places, group.points[places], group.rays[places], whitening[places])
        for (place, _), solution in zip(rows, _solutions(problem, [pose for _, pose in rows])):
            if solution:
                found[group.owners[place]].append(solution)
    return [_different(solutions) for solutions in found]


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


@dataclass(frozen=True, slots=True, eq=False)
class _Problem:
    """Fit of P poses to corners; the arrays have the shape (P, N, ...) for N corners each."""

    owners: NDArray[np.int_]
    """Indices (P,) of the landmarks."""
    points: Floats
    rays: Floats
    whitening: Floats

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


def _solutions(problem: _Problem, starts: Sequence[Pose]) -> list[Solution | None]:
    """Refine the P start poses of a problem; return one solution for each, None if the corners do not determine it."""
    with np.errstate(all="ignore"):  # poses behind the camera, or that diverge
        places = problem.at(
            np.array([pose.rotation for pose in starts]), np.array([pose.translation for pose in starts])
        )
        least = np.full(int(np.max(problem.owners)) + 1, np.inf)
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
        Solution(Pose(rotation, translation), its_covariance, chi2, its_error) if good else None
        for rotation, translation, its_covariance, chi2, its_error, good in zip(
            places.rotation, places.translation, covariance, places.chi2.tolist(), error.tolist(), usable.tolist()
        )
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
    determinants = np.linalg.det(matrices)
    invertible: NDArray[np.bool_] = (determinants > 0) & (determinants < np.inf)
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
    for group in _groups(seen):
        members = [seen[owner] for owner in group.owners]
        rows = [solution for owner in group.owners for solution in found[owner]]
        counts = [len(found[owner]) for owner in group.owners]
        of, firsts = np.repeat(np.arange(len(counts)), counts), np.cumsum([0, *counts[:-1]])
        rotation = np.array([solution.pose.rotation for solution in rows])
        points = group.points[of]
        rays, derivative = predict_all(rotation, np.array([solution.pose.translation for solution in rows]), points)
        larger = (derivative[..., :3] @ (points @ np.swapaxes(rotation, 1, 2))[..., None]).reshape(len(rows), -1, 1)
        shifts = np.concatenate([np.array([one.shifts for one in members]), side_sigma * larger[firsts]], axis=2)
        whole = np.array([one.own_covariance for one in members]) + shifts @ np.swapaxes(shifts, 1, 2)
        inverse = np.linalg.inv(whole)[of]
        by_pose = derivative.reshape(len(rows), -1, 6)
        weighed = np.swapaxes(by_pose, 1, 2) @ inverse
        missed = (group.rays[of] - rays).reshape(len(rows), -1, 1)
        # chi squared of the pose that fits best if all errors are considered, near the pose
        left = missed - by_pose @ np.linalg.solve(weighed @ by_pose, weighed @ missed)
        chi2 = (left * (inverse @ left)).sum(axis=(1, 2))
        alone = np.array([solution.covariance for solution in rows])
        gain = alone @ np.swapaxes(by_pose, 1, 2) @ np.linalg.inv(group.covariance)[of]
        covariance = gain @ whole[of] @ np.swapaxes(gain, 1, 2)
        # The factor by which covariances are too small; 1 if chi squared can be chance.
        freedom = group.rays[0].size - 6
        least = np.minimum.reduceat(chi2, firsts)
        factors = np.where(least > gate_limit(freedom), least / freedom, 1.0)
        chi2 /= factors[of]
        covariance = factors[of, None, None] * (covariance + np.swapaxes(covariance, 1, 2)) / 2
        known = [
            Solution(solution.pose, its_covariance, its_chi2, solution.error)
            for solution, its_covariance, its_chi2 in zip(rows, covariance, chi2.tolist())
        ]
        images, shifts = factors[:, None, None] * group.covariance, np.sqrt(factors)[:, None, None] * shifts
        for owner, one, first, factor, image, its_shifts in zip(
            group.owners, members, firsts, factors.tolist(), images, shifts
        ):
            own = None if one.own is None else one.own * factor
            mine = known[first : first + len(found[owner])]
            results[owner] = (
                Corners(one.points, one.rays, image, own, its_shifts),
                sorted(mine, key=lambda solution: solution.chi2),
            )
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
