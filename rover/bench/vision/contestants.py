"""Contestants for pose estimation: roverlink, and plain OpenCV with each corner refinement."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
from roverkit.vision.camera.camera_model import CameraParameters
from roverkit.vision.camera.uncertainty import Uncertainty
from roverkit.vision.images.rendering import Floats, Grey, Lens
from roverkit.vision.markers.marker_set import MarkerSet
from roverkit.vision.markers.tracker import Tracker

from rover.bench.vision.scenes import DICTIONARY, FRAME_NS, SIDE, corner_points

OURS = "roverlink"
REFINEMENTS = {
    "OpenCV": cv2.aruco.CORNER_REFINE_NONE,
    "OpenCV SUBPIX": cv2.aruco.CORNER_REFINE_SUBPIX,
    "OpenCV APRILTAG": cv2.aruco.CORNER_REFINE_APRILTAG,
}


@dataclass(frozen=True, slots=True)
class Estimate:
    """Number and pose of a marker in the camera's optical frame, with the covariance (6, 6) if known."""

    number: int
    rotation: Floats
    translation: Floats
    covariance: Floats | None = None


Estimator = Callable[[Grey], Sequence[Estimate]]


EXACT = Uncertainty(side_sigma=0, corner_floor=0)
"""Uncertainty of rendered markers: their sides and corners are exact."""


def estimators(lens: Lens) -> dict[str, Estimator]:
    """Return functions that estimate poses from single frames, by name; camera and markers are exact."""
    plain = {name: _Plain(lens, refinement) for name, refinement in REFINEMENTS.items()}
    return {OURS: Ours(exact_camera_of(lens), EXACT), **plain}


def exact_camera_of(lens: Lens) -> CameraParameters:
    """Return roverlink's parameters of a lens, which are known to be exact."""
    return replace(camera_of(lens), covariance=np.zeros((4, 4)))


def camera_of(lens: Lens) -> CameraParameters:
    """Return roverlink's parameters of a lens."""
    return CameraParameters(lens.matrix, np.array(lens.distortion), lens.size)


def plain_detector(refinement: int = cv2.aruco.CORNER_REFINE_NONE, dictionary: int = DICTIONARY) -> Any:
    """Return OpenCV's detector with its defaults."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = refinement
    return cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(dictionary), parameters)


class Ours:
    """Estimator of roverlink; an image may have an earlier one, from which the speed of the image follows."""

    def __init__(self, camera: CameraParameters, uncertainty: Uncertainty) -> None:
        self._tracker = Tracker(camera, MarkerSet(side=SIDE), uncertainty=uncertainty)

    def __call__(self, frame: Grey, earlier: Grey | None = None) -> Sequence[Estimate]:
        """Estimate the poses in a frame; `earlier` is the frame before it."""
        self._tracker.reset()  # each frame by itself, without help of earlier ones
        if earlier is not None:
            self._tracker.track(earlier, 0)
        return [
            Estimate(detection.id, detection.pose.rotation, detection.pose.translation, detection.covariance)
            for detection in self._tracker.track(frame, FRAME_NS)
            if isinstance(detection.id, int)
        ]


class _Plain:
    def __init__(self, lens: Lens, refinement: int) -> None:
        self._lens, self._detector = lens, plain_detector(refinement)

    def __call__(self, frame: Grey) -> Sequence[Estimate]:
        corners, numbers, _ = self._detector.detectMarkers(frame)
        found = [] if numbers is None else np.reshape(numbers, -1).tolist()
        return [self._estimate(number, np.reshape(corner, (4, 2))) for number, corner in zip(found, corners)]

    def _estimate(self, number: int, corners: Any) -> Estimate:
        distortion = np.array(self._lens.distortion)
        points = corner_points()
        _, turn, shift = cv2.solvePnP(
            points, corners.astype(float), self._lens.matrix, distortion, flags=cv2.SOLVEPNP_IPPE_SQUARE
        )
        return Estimate(number, cv2.Rodrigues(turn)[0], np.ravel(shift))
