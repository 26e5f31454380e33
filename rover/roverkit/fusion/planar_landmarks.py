"""Landmarks, and detections of them, on the plane of the field.

A landmark's pose on the plane has the yaw 0 if the landmark stands as the survey says, however it is mounted: the yaw
is its rotation about the vertical since the survey. So a landmark on the ground has one as well as one on a wall.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable

import numpy as np

from roverkit.driving.arcs import PlanarPose
from roverkit.fusion.planar_gaussian import PlanarGaussian, is_covariance, rotation
from roverkit.vision.localization.landmarks import Landmarks
from roverkit.vision.markers.marker_set import TargetId
from roverkit.vision.poses.pose import Pose, rotation_of_quaternion
from roverlink.runtime.interfaces import geometry_msgs, vision_msgs

_PLANAR = np.ix_([0, 1, 5], [0, 1, 5])
"""Rows and columns of x, y and the rotation about z, in a covariance of a pose in space."""


def surveyed_places(landmarks: Landmarks) -> dict[TargetId, PlanarGaussian]:
    """Return the places of the landmarks on the plane, with the accuracy of the survey."""
    return {
        name: PlanarGaussian(
            PlanarPose(float(landmark.pose.translation[0]), float(landmark.pose.translation[1]), 0.0),
            np.diag([landmark.position_sigma, landmark.position_sigma, landmark.rotation_sigma]) ** 2,
        )
        for name, landmark in landmarks.places.items()
    }


def planar_detections(
    message: vision_msgs.Detection3DArray,
    mount: Pose,
    landmarks: Landmarks,
    leave_out: Callable[[str], None] = lambda _: None,
) -> dict[TargetId, PlanarGaussian]:
    """Return the places of the surveyed landmarks in a message of ``roverlink aruco track``, in the rover's frame.

    ``mount`` is the transform from the camera's frame to the rover's. Markers that share a number are left out, and
    those without a usable pose or covariance; ``leave_out`` is called with the reason for the latter.
    """
    names = {str(name): name for name in landmarks.places}
    numbers = Counter(detection.results[0].hypothesis.class_id for detection in message.detections if detection.results)
    detections = {}
    for detection in message.detections:
        if (
            not detection.id
            or not detection.results
            or numbers[detection.results[0].hypothesis.class_id] > 1
            or (name := names.get(detection.results[0].hypothesis.class_id)) is None
        ):
            continue
        seen = detection.results[0].pose
        place = mount @ _pose(seen.pose)
        turn = place.rotation @ landmarks.places[name].pose.rotation.T
        yaw = math.atan2(turn[1, 0], turn[0, 0])
        # From the axes of the camera to those of the rover, and then to those of the landmark on the plane.
        turned = np.kron(np.eye(2), mount.rotation)
        covariance = (turned @ np.reshape(seen.covariance, (6, 6)) @ turned.T)[_PLANAR]
        own = rotation(yaw).T @ covariance @ rotation(yaw)
        x, y, _ = place.translation.tolist()
        if is_covariance(own) and (pose := PlanarPose(x, y, yaw)).is_on_earth:
            detections[name] = PlanarGaussian(pose, own)
        else:
            leave_out(f"sighting of landmark {name} left out: it has no pose or no covariance")
    return detections


def _pose(pose: geometry_msgs.Pose) -> Pose:
    turn, place = pose.orientation, pose.position
    return Pose(
        rotation_of_quaternion(np.array([turn.x, turn.y, turn.z, turn.w])), np.array([place.x, place.y, place.z])
    )
