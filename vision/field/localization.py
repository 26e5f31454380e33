"""Where the camera is on a field whose landmarks are known.

All landmarks in view decide together: their corners are predicted from the camera's pose, and the differences are
weighed by the noise of the image and by how well each landmark was surveyed. A landmark that was moved, or is another
than one thinks, does not fit the pose that the others agree on; it is left out and named.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from roverlink.vision.camera.camera_model import Floats
from roverlink.vision.field.landmarks import Landmark, Landmarks
from roverlink.vision.markers.marker_set import TargetId
from roverlink.vision.markers.tracker import Sighting
from roverlink.vision.poses.pnp import chi2_limit
from roverlink.vision.poses.pose import Pose, predict

_SLACK = (100.0, 10.0, 3.0, 1.0, 1.0)
"""A start comes from one landmark, and may fit the others badly at first: by how much, in chi squared's limits."""
_SINGULAR = 1e14
"""Condition number of a normal matrix that determines no pose."""
_TRIED = 4
"""How many starts are followed at most; one is enough where all landmarks agree."""
_STEPS = 15
_CONVERGED = 1e-4  # change of chi squared, in parts of it


@dataclass(frozen=True, slots=True, eq=False)
class FieldPose:
    """Where the camera is."""

    frame: str
    pose: Pose
    """Takes points of the camera's optical frame to the field's, in metres."""
    covariance: Floats
    """(6, 6): x y z rotX rotY rotZ, about the field's axes."""
    used: tuple[TargetId, ...]
    """The landmarks that agree."""
    rejected: tuple[TargetId, ...]
    """The landmarks that do not: moved, or not what the landmarks say."""


def localize(sightings: Sequence[Sighting], landmarks: Landmarks) -> FieldPose | None:
    """The camera's pose on the field from all sightings of known landmarks; None where there is none.

    Of two landmarks that contradict each other nobody can tell which is wrong: the one that is surer is used.
    """
    known = [_known(one, landmarks.places[one.id]) for one in sightings if one.id in landmarks.places]
    starts = [
        solution.pose @ landmarks.places[one.sighting.id].pose.inverse()
        for one in known
        for solution in one.sighting.solutions
    ]
    starts.sort(key=lambda start: _cost(known, start, _SLACK[0]))
    best: tuple[float, Pose, list[_Known]] | None = None
    for start in starts[:_TRIED]:
        outcome = _agree(known, start)
        if outcome and (best is None or outcome[0] < best[0]):
            best = outcome
        if best and len(best[2]) == len(known):
            break
    if best is None:
        return None
    _, pose, used = best
    normal, _, _ = _normal(used, pose)
    return FieldPose(
        frame=landmarks.frame,
        pose=pose.inverse(),
        covariance=_of_inverse(pose, np.linalg.inv(normal)),
        used=tuple(one.sighting.id for one in used),
        rejected=tuple(one.sighting.id for one in known if one not in used),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Known:
    """A sighting of a known landmark."""

    sighting: Sighting
    points: Floats
    """The corners (N, 3) on the field."""
    whitening: Floats
    """Makes residuals (2N,) independent, with a standard deviation of 1."""
    limit: float
    """The chi squared that it has by chance once in a thousand."""


def _known(sighting: Sighting, landmark: Landmark) -> _Known:
    """Add the landmark's own uncertainty to the image's.

    Its sigmas are the same along all axes, so it can be taken in the camera's, from the pose that was seen.
    """
    seen = sighting.seen
    _, derivative = predict(sighting.pose, seen.points)
    by_landmark = derivative.reshape(-1, 6) * np.repeat([landmark.position_sigma, landmark.rotation_sigma], 3)
    whitening = np.linalg.inv(np.linalg.cholesky(seen.covariance + by_landmark @ by_landmark.T))
    return _Known(sighting, landmark.pose.apply(seen.points), whitening, chi2_limit(2 * len(seen.points)))


def _agree(known: Sequence[_Known], pose: Pose) -> tuple[float, Pose, list[_Known]] | None:
    """From a start (field to camera): the cost, the pose, and the sightings that fit it."""
    used: list[_Known] = []
    for slack in _SLACK:
        used = [one for one in known if _chi2(one, pose) < slack * one.limit]
        refined = _refine(used, pose) if used else None
        if refined is None:
            return None
        pose = refined
    return _cost(known, pose), pose, used


def _cost(known: Sequence[_Known], pose: Pose, slack: float = 1.0) -> float:
    """Chi squared, where what does not fit counts no more than what hardly does."""
    return sum(min(_chi2(one, pose), slack * one.limit) for one in known)


def _chi2(one: _Known, pose: Pose) -> float:
    residuals, _ = _terms(one, pose)
    chi2 = float(residuals @ residuals)
    return chi2 if np.isfinite(chi2) else np.inf


def _terms(one: _Known, pose: Pose) -> tuple[Floats, Floats]:
    """Residuals (2N,) in standard deviations and their derivative (2N, 6) by the pose (field to camera)."""
    rays, derivative = predict(pose, one.points)
    return one.whitening @ (one.sighting.seen.rays - rays).ravel(), one.whitening @ derivative.reshape(-1, 6)


def _normal(used: Sequence[_Known], pose: Pose) -> tuple[Floats, Floats, float]:
    """The normal matrix (6, 6), the right side (6,) and chi squared at a pose."""
    normal, right, chi2 = np.zeros((6, 6)), np.zeros(6), 0.0
    for one in used:
        residuals, derivative = _terms(one, pose)
        normal += derivative.T @ derivative
        right += derivative.T @ residuals
        chi2 += float(residuals @ residuals)
    return normal, right, chi2


def _refine(used: Sequence[_Known], pose: Pose) -> Pose | None:
    """Gauss-Newton steps, halved while they make it worse."""
    normal, right, chi2 = _normal(used, pose)
    for _ in range(_STEPS):
        if not np.isfinite(chi2) or not np.linalg.cond(normal) < _SINGULAR:
            return None
        change = np.linalg.solve(normal, right)
        for part in (1.0, 0.5, 0.25, 0.1):
            moved = pose.moved(part * change)
            trial = _normal(used, moved)
            if trial[2] <= chi2:
                break
        else:
            return pose
        gain = chi2 - trial[2]
        pose, (normal, right, chi2) = moved, trial
        if gain < _CONVERGED * (1 + chi2):
            break
    return pose


def _of_inverse(pose: Pose, covariance: Floats) -> Floats:
    """The covariance (6, 6) of a pose's inverse.

    With R' = exp(r) R and t' = t + d, the inverse turns by -R^T r and its translation -R'^T t' changes by
    -R^T (d + t x r).
    """
    back = pose.rotation.T
    change = np.zeros((6, 6))
    change[:3, :3] = -back
    change[:3, 3:] = -back @ np.cross(pose.translation, np.eye(3)).T
    change[3:, 3:] = -back
    result = change @ covariance @ change.T
    symmetric: Floats = (result + result.T) / 2
    return symmetric
