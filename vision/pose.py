"""Where a marker or a board is, from its corners: both solutions, and how uncertain each is.

Corners are taken as rays, so that no lens enters here. A pose's error is (dx, dy, dz, rx, ry, rz): the true
translation is t + d, the true rotation exp([r]x) R; both in the axes of the frame that the pose is given in, as in
ROS 2's `PoseWithCovariance`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vision._opencv import cv2
from vision.camera import Floats

STEPS = 30
HOPELESS = 1000.0
"""A start is not refined whose chi squared is so many times the best start's: IPPE's solutions are nearly minima."""
_CONVERGED = 1e-3
"""Change of chi squared, in parts of it, at which a refinement ends."""
_SAME = np.radians(0.05)
"""Solutions whose rotations differ less are one."""
_MOST_DAMPED = 1e6
_HALF_TURN = -0.99  # cosine
_NORMAL_QUANTILE = 3.09  # 99.9 %


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """Takes points of one frame to another: `rotation` (3, 3) @ point + `translation` (3,) in metres."""

    rotation: Floats
    translation: Floats

    def apply(self, points: Floats) -> Floats:
        """The points (..., 3) in the other frame."""
        moved: Floats = points @ self.rotation.T + self.translation
        return moved

    def __matmul__(self, first: Pose) -> Pose:
        return Pose(self.rotation @ first.rotation, self.rotation @ first.translation + self.translation)

    def inverse(self) -> Pose:
        """The way back."""
        return Pose(self.rotation.T, -self.rotation.T @ self.translation)

    def moved(self, change: Floats) -> Pose:
        """The pose after a change (6,): x y z rotX rotY rotZ."""
        return Pose(rotation_of(change[3:]) @ self.rotation, self.translation + change[:3])

    def change_to(self, other: Pose) -> Floats:
        """The change (6,) that makes this pose the other: the inverse of `moved`."""
        return np.concatenate([other.translation - self.translation, angles_of(other.rotation @ self.rotation.T)])

    def angle_to(self, other: Pose) -> float:
        """The angle in radians between both rotations."""
        return float(np.linalg.norm(angles_of(other.rotation @ self.rotation.T)))


@dataclass(frozen=True, slots=True, eq=False)
class Corners:
    """What was seen of a landmark: points (N, 3) in its frame, and their rays (N, 2) with covariance (2N, 2N)."""

    points: Floats
    rays: Floats
    covariance: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """A pose (landmark to camera) at which the corners fit best among the poses near it."""

    pose: Pose
    covariance: Floats
    """(6, 6): x y z rotX rotY rotZ."""
    chi2: float
    """Squared residuals in standard deviations; about 2N - 6 where all is as assumed."""
    error: float
    """Root of the mean squared distance between corners and their projections, in the plane z = 1."""


def rotation_of(angles: Floats) -> Floats:
    """The rotation (3, 3) about an axis (3,) by its length in radians."""
    rotation: Floats = cv2.Rodrigues(np.asarray(angles, dtype=float))[0]
    return rotation


def angles_of(rotation: Floats) -> Floats:
    """The inverse of `rotation_of`. OpenCV's takes angles below 1e-5 for nothing, so it only does the half turns."""
    (_, a, b), (c, _, d), (e, f, _) = rotation.tolist()
    sine = math.sqrt((f - d) ** 2 + (b - e) ** 2 + (c - a) ** 2) / 2
    cosine = (float(rotation.trace()) - 1) / 2
    if cosine < _HALF_TURN:
        angles: Floats = cv2.Rodrigues(rotation)[0].ravel()
        return angles
    factor = math.atan2(sine, cosine) / sine / 2 if sine else 0.5
    return np.array([f - d, b - e, c - a]) * factor


def quaternion_of(rotation: Floats) -> Floats:
    """A rotation (3, 3) as the quaternion x y z w of length 1, w not negative."""
    angles = angles_of(rotation)
    half = float(np.linalg.norm(angles)) / 2
    return np.append(angles / 2 * np.sinc(half / np.pi), math.cos(half))


def square_poses(points: Floats, rays: Floats) -> list[Pose]:
    """Both poses of one marker's corners (4, 3), a square anywhere in its landmark's frame, seen at rays (4, 2).

    IPPE (Collins and Bartoli, 2014), by OpenCV.
    """
    right, up = points[1] - points[0], points[0] - points[3]
    side = float(np.linalg.norm(right))
    (a, b, c), (d, e, f) = right / side, up / side
    own = np.array([[a, d, b * f - c * e], [b, e, c * d - a * f], [c, f, a * e - b * d]])
    in_landmark = Pose(own, points.mean(axis=0))
    h = side / 2
    corners = np.array([[-h, h, 0], [h, h, 0], [h, -h, 0], [-h, -h, 0]])
    _, turns, shifts, _ = cv2.solvePnPGeneric(
        corners, rays.reshape(4, 1, 2), np.eye(3), None, flags=cv2.SOLVEPNP_IPPE_SQUARE
    )
    poses = [Pose(rotation_of(turn), np.ravel(shift)) for turn, shift in zip(turns, shifts)]
    return [
        pose @ in_landmark.inverse() for pose in poses if np.isfinite(pose.rotation).all() and pose.translation[2] > 0
    ]


def solve(corners: Corners, starts: Sequence[Pose]) -> list[Solution]:
    """Refine each start; the different outcomes, best first."""
    try:
        whitening = np.linalg.inv(np.linalg.cholesky(corners.covariance))
    except np.linalg.LinAlgError:
        return []
    solutions: list[Solution] = []
    found = _refine_likely(corners, whitening, starts)
    for solution in sorted((one for one in found if one), key=lambda one: one.chi2):
        if all(solution.pose.angle_to(other.pose) > _SAME for other in solutions):
            solutions.append(solution)
    return solutions


def predict(pose: Pose, points: Floats) -> tuple[Floats, Floats]:
    """The rays (N, 2) of points (N, 3), and their derivative (N, 2, 6) by the pose's change; nan behind the camera."""
    turned = points @ pose.rotation.T
    seen = turned + pose.translation
    z = np.where(seen[:, 2] > 0, seen[:, 2], np.nan)
    rays = seen[:, :2] / z[:, None]
    (u, v), (x, y, depth) = rays.T, turned.T
    derivative = np.zeros((len(points), 2, 6))
    derivative[:, 0, 0] = derivative[:, 1, 1] = 1
    derivative[:, :, 2] = -rays
    # a turn r moves a point by r x turned
    derivative[:, 0, 3], derivative[:, 0, 4], derivative[:, 0, 5] = -u * y, depth + u * x, -y
    derivative[:, 1, 3], derivative[:, 1, 4], derivative[:, 1, 5] = -depth - v * y, v * x, x
    return rays, derivative / z[:, None, None]


@dataclass(frozen=True, slots=True, eq=False)
class _Place:
    """How a pose fits: residuals (2N,) in standard deviations, the prediction's derivative (2N, 6), and chi squared."""

    pose: Pose
    residuals: Floats
    derivative: Floats
    chi2: float


def _place(corners: Corners, whitening: Floats, pose: Pose) -> _Place:
    rays, derivative = predict(pose, corners.points)
    residuals = whitening @ (corners.rays - rays).ravel()
    return _Place(pose, residuals, whitening @ derivative.reshape(-1, 6), float(residuals @ residuals))


def _refine_likely(corners: Corners, whitening: Floats, starts: Sequence[Pose]) -> list[Solution | None]:
    """Refine what may be true; what is far behind already stays as it is."""
    places = [_place(corners, whitening, start) for start in starts]
    least = min((place.chi2 for place in places), default=0.0)
    return [
        _solution(corners, _refine(corners, whitening, place) if place.chi2 < HOPELESS * (1 + least) else place)
        for place in places
    ]


def _refine(corners: Corners, whitening: Floats, place: _Place) -> _Place:
    """Levenberg and Marquardt's method."""
    damping = 1e-4
    for _ in range(STEPS):
        normal = place.derivative.T @ place.derivative
        if not math.isfinite(normal.sum()):
            break
        normal.flat[::7] *= 1 + damping
        change = np.linalg.solve(normal, place.derivative.T @ place.residuals)
        moved = _place(corners, whitening, place.pose.moved(change))
        if not moved.chi2 <= place.chi2:  # nan, too
            if damping > _MOST_DAMPED:
                break
            damping *= 10
            continue
        gain, place, damping = place.chi2 - moved.chi2, moved, damping / 10
        if gain < _CONVERGED * (0.1 + place.chi2):
            break
    return place


def _solution(corners: Corners, place: _Place) -> Solution | None:
    """What a place is worth; None where the corners determine no pose there."""
    try:
        covariance = np.linalg.inv(place.derivative.T @ place.derivative)
    except np.linalg.LinAlgError:
        return None
    if not covariance.diagonal().min() > 0:  # nan, too
        return None
    miss = corners.rays - predict(place.pose, corners.points)[0]
    return Solution(
        place.pose, (covariance + covariance.T) / 2, place.chi2, float(np.sqrt((miss**2).sum(axis=1).mean()))
    )


def doubted(corners: Corners, solutions: Sequence[Solution]) -> tuple[Corners, list[Solution]]:
    """Both with larger covariances where the best chi squared is not chance.

    Then the camera's parameters, the marker's side or its flatness are not what one thinks.
    """
    freedom = corners.rays.size - 6
    chi2 = solutions[0].chi2
    if chi2 <= chi2_limit(freedom):
        return corners, list(solutions)
    factor = chi2 / freedom
    wider = [replace(one, covariance=one.covariance * factor, chi2=one.chi2 / factor) for one in solutions]
    return replace(corners, covariance=corners.covariance * factor), wider


def chi2_limit(freedom: int) -> float:
    """What chi squared of so many degrees of freedom exceeds once in a thousand (Wilson and Hilferty, 1931)."""
    part = 2 / (9 * freedom)
    return float(freedom * (1 - part + _NORMAL_QUANTILE * part**0.5) ** 3)
