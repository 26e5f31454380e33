"""``roverlink fuse`` with the messages of a real rclpy node."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from needs import NO_GTSAM, NO_OPENCV
from polling import wait_until
from programs import Start

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("gtsam", reason=NO_GTSAM)

from judge import Judge, interface  # skips this module where there is no rclpy
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message

from rover.tests.fusion_loop import TOPICS, fuse_a_drive


def test_a_drive_with_a_real_node(judge: Judge, start: Start, middleware: str, tmp_path: Path) -> None:
    """Odometry and landmarks come from an rclpy node, which hears the pose; the program uses either middleware."""
    heard = judge.hear("/odometry/global", "nav_msgs/msg/Odometry")
    publishers = {
        topic: judge.node.create_publisher(interface(kind.__msgtype__), topic, QoSProfile(depth=1000))
        for topic, kind in TOPICS.items()
    }

    def send(topic: str, data: bytes) -> None:
        publisher = publishers[topic]
        wait_until(lambda: publisher.get_subscription_count() > 0, f"a subscriber of {topic}")
        publisher.publish(deserialize_message(data, publisher.msg_type))
        time.sleep(0.005)  # as sensors do, and not all at once: the program keeps the newest ten

    fuse_a_drive(start, middleware, tmp_path, send, lambda: heard.values)
