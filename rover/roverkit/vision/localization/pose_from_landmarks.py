"""Pose of a camera, or of a rover with several cameras, on a field with known landmarks.

All visible landmarks are used together. The pose predicts where their corners are seen. The differences to the
observed corners are weighted by the image noise and by the accuracy with which each landmark was surveyed. A landmark
that was moved or misidentified does not fit the pose that follows from the others; it is left out and reported.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from roverkit.gating import gate_limit
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.localization.landmarks import Landmark, Landmarks
from roverkit.vision.markers.marker_set import TargetId
from roverkit.vision.markers.tracker import LandmarkDetection
from roverkit.vision.poses.pnp import mixed_covariance
from roverkit.vision.poses.pose import IDENTITY, Pose, predict

_SLACK = (100.0, 10.0, 3.0, 1.0, 1.0)
"""Factors by which the chi-squared limit of a landmark is multiplied in successive rounds of refinement.

A start pose comes from a single landmark and may fit the others badly at first.
"""
_SINGULAR = 1e14
"""Condition number of the normal matrix above which the corners do not determine the pose."""
_TRIED = 4
"""Largest number of start poses that are refined; one is enough if all landmarks agree."""
_ANOTHER = math.radians(5)
"""Angle in radians between two poses above which they are different ones, and not the same with errors."""
_UNLIKELY = 30.0
"""Chi squared by which a start pose may be worse than the best pose; above, it is too improbable to be refined."""
_STEPS = 15
_CONVERGED = 1e-4  # relative change of chi squared


@dataclass(frozen=True, slots=True, eq=False)
class FieldPose:
    """Pose of a camera or a rover on the field, computed from the visible landmarks (markers and boards)."""

    frame: str
    pose: Pose
    """Transform from the camera's optical frame, or from the rover's frame, to the field's frame, in metres."""
    covariance: Floats
    """Covariance (6, 6) of x y z rotX rotY rotZ, about the field's axes."""
    used: tuple[TargetId, ...]
    """Landmarks from which the pose is computed, because they agree with each other."""
    rejected: tuple[TargetId, ...]
    """Visible landmarks that do not fit the pose and are ignored: they were moved or misidentified."""

    @property
    def agreed(self) -> bool:
        """True if most of the visible landmarks agree; otherwise it is unknown which of them are wrong."""
        return len(self.used) > len(self.rejected)


class CameraDetections(NamedTuple):
    """Landmarks in a frame of one camera of a rover."""

    detections: Sequence[LandmarkDetection]
    mount: Pose = IDENTITY
    """Transform from the camera's optical frame to the rover's frame, in metres."""


def localize(detections: Sequence[LandmarkDetection], landmarks: Landmarks) -> FieldPose | None:
    """Return the camera's pose on the field; None if no landmark with a known pose is visible.

    `detections` are the markers and boards found in one frame; the pose is computed from all that are in `landmarks`. A
    marker whose number others share is no landmark.
    """
    return localize_rover([CameraDetections(detections)], landmarks)


def localize_rover(seen: Sequence[CameraDetections], landmarks: Landmarks) -> FieldPose | None:
    """Return the pose on the field of a rover with several cameras; None if no known landmark is visible.

    `seen` is what the cameras have seen at nearly the same time. A marker whose number others share is no landmark,
    even for the cameras that see only one of them.

    If only two landmarks are visible and contradict each other, it is unknown which one is wrong. Then the more
    accurate one is used, and `FieldPose.agreed` is false.
    """
    shared = {detection.id for camera in seen for detection in camera.detections if detection.shared}
    known = [
        _known(detection, landmarks.places[detection.id], index, camera.mount)
        for index, camera in enumerate(seen)
        for detection in camera.detections
        if detection.id in landmarks.places and detection.id not in shared
    ]
    starts = [
        _Start(observation.mount @ solution.pose @ landmarks.places[observation.detection.id].pose.inverse(), misfit)
        for observation in known
        for solution, misfit in zip(observation.detection.solutions, _misfits(observation.detection))
    ]
    # With several landmarks, their places decide. A single one has its earlier frames, too.
    alone = len(known) == 1
    costs = [start.misfit if alone else _cost(known, start.pose, _SLACK[0]) for start in starts]
    # Best start first: usually it explains all landmarks, and no other one is near.
    found: list[_Outcome] = []
    for cost, start in sorted(zip(costs, starts), key=lambda pair: pair[0])[:_TRIED]:
        explained = any(len(other.used) == len(known) and not other.may_differ(start.pose, cost) for other in found)
        if not explained and (outcome := _agree(known, start.pose)):
            found.append(replace(outcome, cost=start.misfit) if alone else outcome)
    if not found:
        return None
    best = min(found, key=lambda outcome: outcome.cost)
    pose, used = best.pose, best.used
    rivals = [best, *(other for other in found if other.pose.angle_to(pose) > _ANOTHER)]
    weights = [math.exp((best.cost - other.cost) / 2) for other in rivals]
    possible = [
        (weight / sum(weights), other.pose.inverse(), _of_inverse(other.pose, _covariance(other.used, other.pose)))
        for weight, other in zip(weights, rivals)
    ]
    return FieldPose(
        frame=landmarks.frame,
        pose=pose.inverse(),
        covariance=mixed_covariance(pose.inverse(), possible),
        used=tuple(observation.detection.id for observation in used),
        rejected=tuple(observation.detection.id for observation in known if observation not in used),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Known:
    """Detection of a landmark whose pose on the field is known."""

    detection: LandmarkDetection
    points: Floats
    """Corners (N, 3) on the field in metres."""
    own: Floats
    """Covariance (2N, 2N) of the corners' rays by errors that only this landmark has, including its survey."""
    whitening: Floats
    """Matrix that makes residuals (2N,), due to all errors, independent with a standard deviation of 1."""
    limit: float
    """Chi squared that a correct landmark exceeds once in a thousand cases."""
    camera: int
    """Index of the camera."""
    mount: Pose
    """Transform from the camera's optical frame to the rover's frame."""


def _known(detection: LandmarkDetection, landmark: Landmark, camera: int, mount: Pose) -> _Known:
    """Return a detection of a known landmark; combine the uncertainties of the image and of the landmark's survey.

    The standard deviations of the survey are equal along all axes. So they can be applied in the camera's frame.
    """
    seen = detection.seen
    _, derivative = predict(detection.pose, seen.points)
    by_landmark = derivative.reshape(-1, 6) * np.repeat([landmark.position_sigma, landmark.rotation_sigma], 3)
    # With L L^T the covariance, L^-1 times the residuals has the identity as its covariance: their sum of squares is
    # chi squared.
    own = seen.own_covariance + by_landmark @ by_landmark.T
    whitening = np.linalg.inv(np.linalg.cholesky(own + seen.shifts @ seen.shifts.T))
    points = landmark.pose.apply(seen.points)
    return _Known(detection, points, own, whitening, gate_limit(2 * len(points)), camera, mount)


class _Start(NamedTuple):
    """Start pose (field to rover), from one possible pose of a landmark."""

    pose: Pose
    misfit: float
    """Misfit of the landmark's pose in this frame and the earlier ones, in chi squared."""


def _misfits(detection: LandmarkDetection) -> list[float]:
    """Return, for each solution of a detection, the misfit by its probability, in chi squared."""
    chances = [
        detection.probability if solution.pose is detection.pose else 1 - detection.probability
        for solution in detection.solutions
    ]
    return [-2 * math.log(max(chance, 1e-12)) for chance in chances]


@dataclass(frozen=True, slots=True, eq=False)
class _Outcome:
    """Refined pose (field to rover), the detections that fit it, and its cost in chi squared."""

    cost: float
    pose: Pose
    used: list[_Known]

    def may_differ(self, start: Pose, cost: float) -> bool:
        """Return true if a start pose with this cost may lead to another pose that is nearly as probable."""
        return cost < self.cost + _UNLIKELY and self.pose.angle_to(start) > _ANOTHER


def _agree(known: Sequence[_Known], pose: Pose) -> _Outcome | None:
    """Refine a start pose (field to rover) with the detections of landmarks that fit it.

    Returns None if the pose cannot be refined.
    """
    used: list[_Known] = []
    for slack in _SLACK:
        used = [observation for observation in known if _chi2(observation, pose) < slack * observation.limit]
        if not used:  # a compromise between landmarks that contradict each other, which fits none of them
            used = [min(known, key=lambda observation: _chi2(observation, pose) / observation.limit)]
        refined = _refine(used, pose)
        if refined is None:
            return None
        pose = refined
    return _Outcome(_cost(known, pose), pose, used)


def _cost(known: Sequence[_Known], pose: Pose, slack: float = 1.0) -> float:
    """Return the sum of chi squared over all detections; one that does not fit counts only as `slack` * limit."""
    return sum(min(_chi2(observation, pose), slack * observation.limit) for observation in known)


def _chi2(observation: _Known, pose: Pose) -> float:
    residuals, _ = _terms(observation, pose)
    chi2 = float(residuals @ residuals)
    return chi2 if np.isfinite(chi2) else np.inf


def _terms(observation: _Known, pose: Pose) -> tuple[Floats, Floats]:
    """Return the residuals (2N,) of a landmark's corners, and the derivative (2N, 6) of the predicted corners.

    Both are in standard deviations. The derivative is with respect to the pose (field to rover).
    """
    to_camera = observation.mount.inverse()
    rays, by_camera = predict(to_camera @ pose, observation.points)
    # The camera moves and turns as the rover does, seen in its own axes.
    by_rover = by_camera.reshape(-1, 2, 3) @ to_camera.rotation
    return observation.whitening @ (
        observation.detection.seen.rays - rays
    ).ravel(), observation.whitening @ by_rover.reshape(-1, 6)


def _normal(used: Sequence[_Known], pose: Pose) -> tuple[Floats, Floats, float]:
    """Return the normal equations at a pose (matrix (6, 6) and right side (6,)), and the sum of chi squared."""
    normal, right, chi2 = np.zeros((6, 6)), np.zeros(6), 0.0
    for observation in used:
        residuals, derivative = _terms(observation, pose)
        normal += derivative.T @ derivative
        right += derivative.T @ residuals
        chi2 += float(residuals @ residuals)
    return normal, right, chi2


def _covariance(used: Sequence[_Known], pose: Pose) -> Floats:
    """Return the covariance (6, 6) of a pose (field to rover) that was fitted to the corners of landmarks.

    Errors that only one landmark has average out over several landmarks. Shared errors do not: those of a camera's
    parameters and of the side of the markers move all corners that the camera sees at once.
    """
    inverse = np.linalg.inv(_normal(used, pose)[0])
    covariance = np.zeros((6, 6))
    shared: dict[int, Floats] = {}
    for observation in used:
        gain = inverse @ _terms(observation, pose)[1].T @ observation.whitening
        covariance += gain @ observation.own @ gain.T
        shared[observation.camera] = shared.get(observation.camera, 0) + gain @ observation.detection.seen.shifts
    whole: Floats = covariance + sum(moved @ moved.T for moved in shared.values())
    return whole


def _refine(used: Sequence[_Known], pose: Pose) -> Pose | None:
    """Return the pose with the least chi squared, found by Gauss-Newton steps; None if the corners do not determine it.

    A step that makes chi squared larger is shortened.
    """
    normal, right, chi2 = _normal(used, pose)
    for _ in range(_STEPS):
        if not np.isfinite(chi2) or not np.linalg.cond(normal) < _SINGULAR:
            return None
        change = np.linalg.solve(normal, right)
        # Line search: far from the solution a full Gauss-Newton step can overshoot.
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
    """Return the covariance (6, 6) of the inverse of a pose, given the covariance of the pose.

    If R' = exp(r) R and t' = t + d, the inverse rotates by -R^T r, and its translation -R'^T t' changes by -R^T (d + t
    x r).
    """
    back = pose.rotation.T
    change = np.zeros((6, 6))
    change[:3, :3] = -back
    change[:3, 3:] = -back @ np.cross(pose.translation, np.eye(3)).T
    change[3:, 3:] = -back
    result = change @ covariance @ change.T
    symmetric: Floats = (result + result.T) / 2
    return symmetric
