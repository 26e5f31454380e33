"""Tracking of landmarks in the frames of a rover's cameras, and the poses of cameras and rover that follow."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverkit.vision.frames import Frame
from roverkit.vision.localization.landmarks import Landmarks
from roverkit.vision.localization.pose_from_landmarks import CameraDetections, FieldPose, localize
from roverkit.vision.localization.rover_localizer import RoverLocalizer, RoverPose
from roverkit.vision.markers.tracker import LandmarkDetection, Tracker
from roverkit.vision.poses.pose import Pose, quaternion_of

_DIGITS = 9  # significant digits, because covariances are small numbers


@dataclass(frozen=True, slots=True, eq=False)
class LandmarkResult:
    """Result of the tracking in one frame: the landmarks in it, and the poses that follow from them."""

    frame: Frame
    parameters: CameraParameters
    """Parameters of the camera in this frame."""
    detections: tuple[LandmarkDetection, ...]
    camera_pose: FieldPose | None = None
    """Camera's pose on the field; None if the frame shows no known landmark."""
    camera: str = ""
    """Name of the camera, if the rover has several."""
    rover: RoverPose | None = None
    """Rover's pose, if the frame completes what its cameras have seen at one time; None if it is unknown."""

    def as_dict(self) -> dict[str, Any]:
        """Return the results as JSON values: metres, pixels, quaternions x y z w, covariances row by row."""
        markers = [_detection(detection) for detection in self.detections]
        frame = {"stamp": self.frame.stamp, "frame": self.frame.number, "frame_id": self.frame.frame_id}
        found = {**({"name": self.camera} if self.camera else {}), **frame, "markers": markers}
        if self.camera_pose:
            found["camera"] = _field_pose(self.camera_pose)
        if self.rover:
            found["rover"] = {"stamp": self.rover.stamp, **_field_pose(self.rover.field_pose)}
        return found


@dataclass(eq=False)
class MountedCamera:
    """Camera of a rover, as far as poses need it."""

    tracker: Tracker
    name: str = ""
    """Name, if the rover has several cameras."""
    mount: Callable[[Frame], Pose | None] = lambda _: None
    """Function that returns the transform from the optical frame to the rover's at the time of a frame, if known."""


class FieldTracker:
    """Finds the landmarks in the frames of a rover's cameras, and the poses of cameras and rover that follow."""

    def __init__(self, cameras: int = 1, landmarks: Landmarks | None = None) -> None:
        """Track with a number of cameras; without landmarks, no poses on the field are computed."""
        self._cameras = cameras
        self.use(landmarks)

    def use(self, landmarks: Landmarks | None) -> None:
        """Use other landmarks from the next frame on."""
        self._rover = RoverLocalizer(self._cameras, landmarks) if landmarks else None

    def track(self, camera: MountedCamera, frame: Frame) -> LandmarkResult:
        """Return the results of a camera's frame. Call this once for each frame."""
        rover = self._rover
        detections, parameters = camera.tracker.track(frame.image, frame.stamp), camera.tracker.camera
        if rover is None:
            return LandmarkResult(frame, parameters, detections, camera=camera.name)
        mount = camera.mount(frame)
        seen = None if mount is None else CameraDetections(detections, mount)
        camera_pose = localize(detections, rover.landmarks)
        pose = rover.add(camera.name, frame.stamp, seen)
        return LandmarkResult(frame, parameters, detections, camera_pose, camera.name, pose)


def _detection(detection: LandmarkDetection) -> Mapping[str, Any]:
    return {
        "id": detection.id,
        **_pose(detection.pose, detection.covariance),
        "corners": [_numbers(corner) for corner in detection.corners],
        "error": _number(detection.error),
        "other_pose": _other(detection),
        "shared": detection.shared,
    }


def _other(detection: LandmarkDetection) -> Mapping[str, Any] | None:
    """Return the pose of a landmark that was not chosen, as JSON values; None if there is only one possible pose.

    `ambiguity` is the ratio of its reprojection error to that of the chosen pose.
    """
    for solution in detection.solutions:
        if solution.pose is not detection.pose:
            return {**_pose(solution.pose, solution.covariance), "ambiguity": _number(detection.ambiguity)}
    return None


def _field_pose(found: FieldPose) -> Mapping[str, Any]:
    pose = _pose(found.pose, found.covariance) if found.agreed else {}
    return {"frame": found.frame, **pose, "used": list(found.used), "rejected": list(found.rejected)}


def _pose(pose: Pose, covariance: Floats) -> Mapping[str, Any]:
    return {
        "position": _numbers(pose.translation),
        "orientation": _numbers(quaternion_of(pose.rotation)),
        "covariance": _numbers(covariance.ravel()),
    }


def _numbers(values: Floats) -> list[float]:
    return [_number(float(value)) for value in values]


def _number(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
