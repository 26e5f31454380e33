"""Conversion of detected objects to ROS 2 messages, and back.

In vision_msgs, `id` is the number of the object, and `class_id` the name of its class. The pose in a `Detection3D` is
the middle of the surface that the camera sees, in the camera's optical frame (REP 103); its orientation is unknown.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from roverkit.objects.detected_objects import Box, TrackedObject
from roverkit.objects.location import Location
from roverlink.runtime.interfaces import geometry_msgs, vision_msgs
from roverlink.runtime.ros_time.headers import header_of

_UNKNOWN_ANGLE = math.pi**2 / 3
"""Variance of an angle that may have any value: that of the uniform distribution from -pi to pi."""


def detections_2d_of(objects: Sequence[TrackedObject], stamp: int, frame: str) -> vision_msgs.Detection2DArray:
    """Return a message with the boxes of objects in pixels; `stamp` is in nanoseconds since 1970."""
    header = header_of(stamp, frame)
    detections = []
    for tracked in objects:
        box = tracked.box
        centre = vision_msgs.Point2D(box.x + box.width / 2, box.y + box.height / 2)
        bounds = vision_msgs.BoundingBox2D(vision_msgs.Pose2D(centre), box.width, box.height)
        hypothesis = vision_msgs.ObjectHypothesisWithPose(_hypothesis(tracked))
        detections.append(vision_msgs.Detection2D(header, [hypothesis], bounds, str(tracked.id)))
    return vision_msgs.Detection2DArray(header, detections)


def objects_of(message: vision_msgs.Detection2DArray) -> list[TrackedObject]:
    """Return the objects in a message of `detections_2d_of`.

    Detections of other programs, whose id is not a number, or which have no result, are left out.
    """
    found = []
    for detection in message.detections:
        if detection.id.isdecimal() and detection.results:
            centre, width, height = detection.bbox.center.position, detection.bbox.size_x, detection.bbox.size_y
            best = detection.results[0].hypothesis
            box = Box(centre.x - width / 2, centre.y - height / 2, width, height)
            found.append(TrackedObject(int(detection.id), box, best.class_id, best.score))
    return found


def detections_3d_of(
    objects: Sequence[TrackedObject], locations: Mapping[int, Location], stamp: int, frame: str
) -> vision_msgs.Detection3DArray:
    """Return a message with the positions of those objects that have one, by the numbers of the objects.

    The size of a box is 0, because the camera sees the front of an object only.
    """
    header = header_of(stamp, frame)
    detections = []
    for tracked in objects:
        if location := locations.get(tracked.id):
            pose = pose_of(location)
            result = vision_msgs.ObjectHypothesisWithPose(_hypothesis(tracked), pose)
            detections.append(
                vision_msgs.Detection3D(header, [result], vision_msgs.BoundingBox3D(pose.pose), str(tracked.id))
            )
    return vision_msgs.Detection3DArray(header, detections)


def locations_of(message: vision_msgs.Detection3DArray) -> dict[int, Location]:
    """Return the positions in a message of `detections_3d_of`, by the numbers of the objects.

    Detections of other programs, whose id is not a number, or which have no result, are left out.
    """
    found = {}
    for detection in message.detections:
        if detection.id.isdecimal() and detection.results:
            pose = detection.results[0].pose
            point = pose.pose.position
            covariance = np.reshape(pose.covariance, (6, 6))[:3, :3]
            found[int(detection.id)] = Location(np.array([point.x, point.y, point.z]), covariance)
    return found


def pose_of(location: Location) -> geometry_msgs.PoseWithCovariance:
    """Return a pose at a position, with an orientation that is unknown."""
    covariance = np.diag([0.0] * 3 + [_UNKNOWN_ANGLE] * 3)
    covariance[:3, :3] = location.covariance
    return geometry_msgs.PoseWithCovariance(
        geometry_msgs.Pose(geometry_msgs.Point(*location.point.tolist()), geometry_msgs.Quaternion(0.0, 0.0, 0.0, 1.0)),
        covariance.ravel().tolist(),
    )


def _hypothesis(tracked: TrackedObject) -> vision_msgs.ObjectHypothesis:
    return vision_msgs.ObjectHypothesis(tracked.class_name, tracked.confidence)
