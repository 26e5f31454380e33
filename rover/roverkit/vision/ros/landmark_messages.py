"""Conversion of detections (landmarks in a frame, with their poses) to ROS 2 messages.

A marker's frame has x to the right on the print, y up and z out of it. The camera's frame is the optical one (REP 103).
Covariances are about the axes of the frame in which the pose is given, as in `geometry_msgs/PoseWithCovariance`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverkit.vision.camera.parameters_file import model_name
from roverkit.vision.localization.pose_from_landmarks import FieldPose
from roverkit.vision.markers.marker_set import TargetId
from roverkit.vision.markers.tracker import LandmarkDetection
from roverkit.vision.poses.pnp import Solution
from roverkit.vision.poses.pose import Pose, quaternion_of
from roverlink.runtime.interfaces import geometry_msgs, sensor_msgs, tf2_msgs, vision_msgs
from roverlink.runtime.interfaces.std_msgs import Header
from roverlink.runtime.ros_time.headers import header_of


@dataclass(frozen=True, slots=True)
class FrameNames:
    """Names of the coordinate frames in the messages."""

    camera: str
    marker: str
    """Prefix of a marker's number or a board's name."""

    def of(self, target: TargetId) -> str:
        """Return the name of the coordinate frame of a marker or board, such as ``aruco_7`` or ``aruco_gate``."""
        return f"{self.marker}{target}"


def transforms_of(detections: Sequence[LandmarkDetection], names: FrameNames) -> tf2_msgs.TFMessage:
    """Return a message for /tf with the transforms from the camera's frame to the landmarks (markers and boards)."""
    return tf2_msgs.TFMessage(
        [
            transform_of(detection.pose, names.camera, names.of(detection.id), detection.stamp)
            for detection in detections
        ]
    )


def transform_of(pose: Pose, parent: str, child: str, stamp: int) -> geometry_msgs.TransformStamped:
    """Return a message with the transform from the frame `child` to the frame `parent`; `stamp` is in nanoseconds."""
    transform = geometry_msgs.Transform(geometry_msgs.Vector3(*_plain(pose.translation)), _quaternion(pose))
    return geometry_msgs.TransformStamped(header_of(stamp, parent), child, transform)


def marker_pose_of(detection: LandmarkDetection, names: FrameNames) -> geometry_msgs.PoseWithCovarianceStamped:
    """Return a message with the pose of a landmark (marker or board) in the camera's frame, and its covariance."""
    pose = _with_covariance(detection.pose, detection.covariance)
    return geometry_msgs.PoseWithCovarianceStamped(header_of(detection.stamp, names.camera), pose)


def field_pose_of(found: FieldPose, stamp: int) -> geometry_msgs.PoseWithCovarianceStamped:
    """Return a message with a pose on the field and its covariance; `stamp` is in nanoseconds since 1970."""
    pose = _with_covariance(found.pose, found.covariance)
    return geometry_msgs.PoseWithCovarianceStamped(header_of(stamp, found.frame), pose)


def detections_of(
    detections: Sequence[LandmarkDetection], stamp: int, names: FrameNames
) -> vision_msgs.Detection3DArray:
    """Return a message with the landmarks of a frame, each with all its possible poses.

    The first pose of a landmark is the chosen one.
    """
    header = header_of(stamp, names.camera)
    return vision_msgs.Detection3DArray(header, [_detection(detection, header, names) for detection in detections])


def camera_info_of(
    camera: CameraParameters, size: tuple[int, int], stamp: int, names: FrameNames
) -> sensor_msgs.CameraInfo:
    """Return a message with the camera's parameters, for images of `size` (width, height) that are not rectified."""
    width, height = size
    return sensor_msgs.CameraInfo(
        header=header_of(stamp, names.camera),
        height=height,
        width=width,
        distortion_model=model_name(camera),
        d=_plain(camera.distortion),
        k=_plain(camera.matrix.ravel()),
        # For a single camera: no rectification, and P is K with a fourth column of zeros (comments of
        # sensor_msgs/CameraInfo).
        r=_plain(np.eye(3).ravel()),
        p=_plain(np.column_stack([camera.matrix, np.zeros(3)]).ravel()),
    )


def _detection(detection: LandmarkDetection, header: Header, names: FrameNames) -> vision_msgs.Detection3D:
    # False sorts before True: the chosen pose comes first.
    ordered = sorted(detection.solutions, key=lambda solution: solution.pose is not detection.pose)
    results = [
        vision_msgs.ObjectHypothesisWithPose(
            vision_msgs.ObjectHypothesis(str(detection.id), _score(solution, detection.solutions)),
            _with_covariance(solution.pose, solution.covariance),
        )
        for solution in ordered
    ]
    low, high = detection.seen.points.min(axis=0), detection.seen.points.max(axis=0)
    centre = Pose(detection.pose.rotation, detection.pose.apply((low + high) / 2))
    return vision_msgs.Detection3D(
        header,
        results,
        vision_msgs.BoundingBox3D(_pose(centre), geometry_msgs.Vector3(*_plain(high - low))),
        # The id of an object, so two objects cannot have the same one.
        "" if detection.shared else names.of(detection.id),
    )


def _score(solution: Solution, solutions: Sequence[Solution]) -> float:
    """Return the probability that `solution` is the true one of `solutions`, from chi squared of this image only."""
    # Relative to the best one: exp of a large chi squared alone would be 0 for all.
    least = min(other.chi2 for other in solutions)
    weights = [math.exp((least - other.chi2) / 2) for other in solutions]
    return math.exp((least - solution.chi2) / 2) / sum(weights)


def _with_covariance(pose: Pose, covariance: Floats) -> geometry_msgs.PoseWithCovariance:
    return geometry_msgs.PoseWithCovariance(_pose(pose), _plain(covariance.ravel()))


def _pose(pose: Pose) -> geometry_msgs.Pose:
    return geometry_msgs.Pose(geometry_msgs.Point(*_plain(pose.translation)), _quaternion(pose))


def _quaternion(pose: Pose) -> geometry_msgs.Quaternion:
    return geometry_msgs.Quaternion(*_plain(quaternion_of(pose.rotation)))


def _plain(values: Floats) -> list[float]:
    numbers: list[float] = values.astype(float).tolist()
    return numbers
