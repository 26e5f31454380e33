"""Where the camera is on a field whose landmarks are known.

All landmarks in view decide together: their corners are predicted from the camera's pose, and the differences are
weighed by the noise of the image and by how well each landmark was surveyed. A landmark that was moved, or is another
than one thinks, does not fit the pose that the others agree on; it is left out and named.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from vision.camera import Floats
from vision.markers import TargetId
from vision.pose import Pose, chi2_limit, predict
from vision.tracking import Sighting

SURVEY_POSITION = 0.01
"""Standard deviation in metres of a landmark's position along each axis, where none is given."""
SURVEY_ROTATION = float(np.radians(0.5))
"""Standard deviation in radians of a landmark's orientation about each axis, where none is given."""
_STEPS = 15
_CONVERGED = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Landmark:
    """A marker's or board's pose on the field (landmark to field), and how well it is known (one sigma an axis)."""

    pose: Pose
    position_sigma: float = SURVEY_POSITION
    rotation_sigma: float = SURVEY_ROTATION


@dataclass(frozen=True, slots=True, eq=False)
class Landmarks:
    """Where the landmarks of a field are; `frame` is the field's name."""

    frame: str
    places: Mapping[TargetId, Landmark] = field(default_factory=dict)


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
    known = [sighting for sighting in sightings if sighting.id in landmarks.places]
    starts = [
        solution.pose @ landmarks.places[sighting.id].pose.inverse()
        for sighting in known
        for solution in sighting.solutions
    ]
    best: tuple[float, Pose, list[Sighting]] | None = None
    for start in starts:
        outcome = _agree(known, landmarks, start)
        if outcome and (best is None or outcome[0] < best[0]):
            best = outcome
    if best is None:
        return None
    _, pose, used = best
    normal, _, _ = _normal(used, landmarks, pose)
    return FieldPose(
        frame=landmarks.frame,
        pose=pose.inverse(),
        covariance=_of_inverse(pose, np.linalg.inv(normal)),
        used=tuple(sighting.id for sighting in used),
        rejected=tuple(sighting.id for sighting in known if sighting not in used),
    )


def _agree(known: Sequence[Sighting], landmarks: Landmarks, pose: Pose) -> tuple[float, Pose, list[Sighting]] | None:
    """From a start (field to camera): the cost, the pose, and the sightings that fit it."""
    used = [one for one in known if _chi2(one, landmarks, pose) < 4 * _limit(one)] or list(known)
    for _ in range(4):
        refined = _refine(used, landmarks, pose)
        if refined is None:
            return None
        pose = refined
        fitting = [one for one in known if _chi2(one, landmarks, pose) < _limit(one)]
        if not fitting:
            return None
        if fitting == used:
            break
        used = fitting
    cost = sum(min(_chi2(one, landmarks, pose), _limit(one)) for one in known)
    return cost, pose, used


def _limit(sighting: Sighting) -> float:
    return chi2_limit(2 * len(sighting.seen.points))


def _chi2(sighting: Sighting, landmarks: Landmarks, pose: Pose) -> float:
    terms = _terms(sighting, landmarks.places[sighting.id], pose)
    return float(terms[0] @ terms[0]) if np.isfinite(terms[0]).all() else np.inf


def _terms(sighting: Sighting, landmark: Landmark, pose: Pose) -> tuple[Floats, Floats]:
    """Residuals (2N,) in standard deviations and their derivative (2N, 6) by the pose (field to camera)."""
    on_field = landmark.pose.apply(sighting.seen.points)
    rays, derivative = predict(pose, on_field)
    # the landmark's own error (shift along the field's axes, turn about its origin) moves the points on the field
    _, by_landmark = predict(pose @ landmark.pose, sighting.seen.points)
    by_landmark = by_landmark.reshape(-1, 6)
    sigmas = np.repeat([landmark.position_sigma, landmark.rotation_sigma], 3)
    turned = by_landmark * sigmas  # both sigmas are the same along all axes, so the axes do not matter
    try:
        whitening = np.linalg.inv(np.linalg.cholesky(sighting.seen.covariance + turned @ turned.T))
    except np.linalg.LinAlgError:
        return np.full(2 * len(rays), np.inf), derivative.reshape(-1, 6)
    return whitening @ (sighting.seen.rays - rays).ravel(), whitening @ derivative.reshape(-1, 6)


def _normal(used: Sequence[Sighting], landmarks: Landmarks, pose: Pose) -> tuple[Floats, Floats, float]:
    """The normal matrix (6, 6), the right side (6,) and chi squared at a pose."""
    normal, right, chi2 = np.zeros((6, 6)), np.zeros(6), 0.0
    for sighting in used:
        residuals, derivative = _terms(sighting, landmarks.places[sighting.id], pose)
        normal += derivative.T @ derivative
        right += derivative.T @ residuals
        chi2 += float(residuals @ residuals)
    return normal, right, chi2


def _refine(used: Sequence[Sighting], landmarks: Landmarks, pose: Pose) -> Pose | None:
    """Gauss-Newton steps, halved while they make it worse."""
    normal, right, chi2 = _normal(used, landmarks, pose)
    for _ in range(_STEPS):
        if not np.isfinite(chi2) or np.linalg.cond(normal) > 1e14:
            return None
        change = np.linalg.solve(normal, right)
        for part in (1.0, 0.5, 0.25, 0.1):
            moved = pose.moved(part * change)
            trial = _normal(used, landmarks, moved)
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
