"""What of a frame goes to which ROS 2 topic."""

from __future__ import annotations

from typing import Any

import numpy as np

from bench.vision.contestants import camera_of
from bench.vision.scenes import lens
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import geometry_msgs, tf2_msgs, vision_msgs
from roverlink.runtime.middleware import NodeIdentity, open_middleware
from roverlink.vision import Pose
from roverlink.vision.field.view import View
from roverlink.vision.frames import Frame
from roverlink.vision.ros.publishing import Publishing
from tests.vision.seen import FACING, sighting


def test_markers_that_share_a_number_are_in_the_detections_alone() -> None:
    """A frame on /tf and a topic belong to one marker. In the detections each has its pose, and no id as an object."""
    rng = np.random.default_rng(0)
    places = [(7, -0.5, True), (7, 0.5, True), (9, 0.0, False)]
    seen = tuple(
        sighting(number, Pose(FACING, np.array([x, 0, 2.0])), rng, shared=shared) for number, x, shared in places
    )
    topics: dict[str, type[Message]] = {
        "/tf": tf2_msgs.TFMessage,
        "/aruco/detections": vision_msgs.Detection3DArray,
        "/aruco/aruco_7/pose": geometry_msgs.PoseWithCovarianceStamped,
        "/aruco/aruco_9/pose": geometry_msgs.PoseWithCovarianceStamped,
    }
    heard: dict[str, list[Any]] = {topic: [] for topic in topics}
    with open_middleware("memory", NodeIdentity("listener")) as middleware:
        for topic, kind in topics.items():
            middleware.subscribe(topic, kind, Qos(), heard[topic].extend)
        publishing = Publishing(middleware, camera_of(lens()), "aruco_", lambda name: f"/{name.lstrip('/')}")
        publishing.publish(View(Frame(np.zeros((480, 640), np.uint8), 5, 0, "eye"), seen))
    (transforms,), (detections,), none, (_,) = (
        [cdr.decode(topics[topic], data) for data in heard[topic]] for topic in topics
    )
    assert none == []
    assert [one.child_frame_id for one in transforms.transforms] == ["aruco_9"]
    assert [(one.id, one.results[0].hypothesis.class_id) for one in detections.detections] == [
        ("", "7"),
        ("", "7"),
        ("aruco_9", "9"),
    ]
    assert [round(one.bbox.center.position.x, 2) for one in detections.detections] == [-0.5, 0.5, 0]
