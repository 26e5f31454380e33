"""Publisher of a camera's results on ROS 2 topics.

A landmark is a marker or a board. A flat marker has two possible poses. A message is made only if its topic has a
subscriber, because making some of the messages takes long. Markers that share a number are only in the detections and
in the drawn image.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from roverkit.aruco.tracker_declaration import (
    CAMERA_INFO,
    CAMERA_POSE,
    DETECTIONS,
    IMAGE,
    MARKER_POSE,
    TRANSFORMS,
)
from roverkit.vision.images.drawing import draw
from roverkit.vision.localization.field_tracker import LandmarkResult
from roverkit.vision.markers.detection import Image
from roverkit.vision.ros import landmark_messages
from roverkit.vision.ros.image_messages import compressed_of
from roverkit.vision.ros.landmark_messages import FrameNames
from roverkit.vision.ros.outputs import Output, Outputs
from roverlink.runtime.middleware import Middleware


class LandmarkPublisher:
    """Publisher of the results of one camera: poses of landmarks, the drawn image, and the camera's pose."""

    def __init__(
        self,
        middleware: Middleware,
        marker_frame: str,
        topic: Callable[[str], str],
        say: Callable[[str], None] = lambda _: None,
    ) -> None:
        """Create the publishers; `topic` returns the fully qualified name of a topic.

        `marker_frame` is the start of the name of a landmark's coordinate frame, as in `FrameNames`.
        `say` is called with a message if a topic cannot be published, for instance if rclpy lacks the message type.
        """
        self._marker_frame = marker_frame
        self._outputs = outputs = Outputs(middleware, topic, say)
        self._transforms = outputs.open(TRANSFORMS)
        self._detections = outputs.open(DETECTIONS)
        self._camera_info = outputs.open(CAMERA_INFO)
        self._image = outputs.open(IMAGE)
        self._camera_pose = outputs.open(CAMERA_POSE)
        self._poses: dict[str, Output] = {}

    def publish(self, result: LandmarkResult) -> None:
        """Publish the results of a frame on all topics. If the frame has no landmarks, nothing is published on /tf."""
        stamp, detections = result.frame.stamp, result.detections
        names = FrameNames(result.frame.frame_id, self._marker_frame)
        # With two frames of the same name, a listener to /tf would see one marker that jumps.
        if unique := [detection for detection in detections if not detection.shared]:
            self._transforms.put(lambda: landmark_messages.transforms_of(unique, names))
        for detection in unique:
            self._pose_of(names.of(detection.id)).put(partial(landmark_messages.marker_pose_of, detection, names))
        self._detections.put(lambda: landmark_messages.detections_of(detections, stamp, names))
        size = result.frame.size
        self._camera_info.put(lambda: landmark_messages.camera_info_of(result.parameters, size, stamp, names))
        self._image.put(lambda: compressed_of(_drawn(result), stamp, names.camera))
        if (pose := result.camera_pose) and pose.agreed:
            self._camera_pose.put(lambda: landmark_messages.field_pose_of(pose, stamp))

    def _pose_of(self, name: str) -> Output:
        if name not in self._poses:
            self._poses[name] = self._outputs.open(MARKER_POSE.named(name))
        return self._poses[name]


def _drawn(result: LandmarkResult) -> Image:
    return draw(result.frame.image, result.parameters, result.detections, result.camera_pose)
