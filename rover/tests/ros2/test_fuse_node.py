"""``roverlink fuse`` with the messages of a real rclpy node: what a simulated rover publishes on a drive."""

from __future__ import annotations

import math
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from needs import NO_GTSAM, NO_OPENCV
from polling import wait_until
from programs import Start

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("gtsam", reason=NO_GTSAM)

from judge import Judge, interface  # skips this module where there is no rclpy
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message
from roverkit.fusion.fusion_declaration import DETECTIONS, FUSED, ODOMETRY

from rover.tests.driving.field_drive import FieldDrive
from rover.tests.driving.simulated_tracker import write_field
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.interfaces.nav_msgs import Odometry
from roverlink.runtime.interfaces.vision_msgs import Detection3DArray

_METRES = 8.0
_CAMERA = "front"


def test_a_drive_with_a_real_node(judge: Judge, start: Start, middleware: str, tmp_path: Path) -> None:
    """Odometry and landmarks come from an rclpy node, which hears where the rover is; either middleware is used."""
    heard = judge.hear(f"/{FUSED.name}", "nav_msgs/msg/Odometry")
    landmarks, cameras = write_field(tmp_path, _CAMERA)
    program = start("fuse", "--landmarks", landmarks, "--cameras", cameras, "--middleware", middleware)
    sent: list[tuple[Any, bytes]] = []
    with ExitStack() as stack:
        rover = FieldDrive(1, stack)
        for own, kind, folder in ((ODOMETRY.name, Odometry, ""), (DETECTIONS.name, Detection3DArray, f"/{_CAMERA}")):
            publisher = judge.node.create_publisher(
                interface(kind.__msgtype__), f"{folder}/{own}", QoSProfile(depth=1000)
            )
            rover.middleware.subscribe(
                f"/{own}", kind, Qos(), lambda many, one=publisher: sent.extend((one, data) for data in many)
            )
        rover.stand(2)
        rover.drive(_METRES)
        truth, last = rover.model.pose, rover.fused[-1].header.stamp
    program.wait_for(f"waiting for /{ODOMETRY.name}")
    for publisher, data in sent:
        wait_until(publisher.get_subscription_count, f"a subscriber of {publisher.topic_name}")
        publisher.publish(deserialize_message(data, publisher.msg_type))
        time.sleep(0.005)  # as sensors do, and not all at once: the program keeps the newest ten

    def end() -> list[dict[str, Any]]:
        stamp = {"sec": last.sec, "nanosec": last.nanosec}
        return [one for one in heard.values[-1:] if one["header"]["stamp"] == stamp]

    (pose,) = wait_until(end, f"the last pose on /{FUSED.name}")
    place = pose["pose"]["pose"]["position"]
    assert pose["header"]["frame_id"] == "map"
    assert math.hypot(place["x"] - truth.x, place["y"] - truth.y) < 0.15
    assert program.interrupt() == 0
