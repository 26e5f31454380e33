"""``roverlink fuse``: bad input, and a drive over DDS."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from needs import NO_GTSAM, NO_OPENCV, needs_dds
from node_in_memory import hear
from polling import wait_until
from programs import Start

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("gtsam", reason=NO_GTSAM)

from rover.tests.fusion_loop import TOPICS, fuse_a_drive
from roverlink.runtime import Qos
from roverlink.runtime.interfaces.nav_msgs import Odometry
from roverlink.runtime.middleware import NodeIdentity, open_middleware
from roverlink.runtime.text.values import message_to_values


@needs_dds
@pytest.mark.slow
def test_a_drive_over_dds(start: Start, tmp_path: Path) -> None:
    """The program finds where the rover is, and ends with Ctrl-C."""
    with open_middleware("dds", NodeIdentity("rover")) as node:
        heard = hear(node, "/odometry/global", Odometry, Qos(depth=1000))
        publishers = {topic: node.publisher(topic, kind, Qos(depth=1000)) for topic, kind in TOPICS.items()}

        def send(topic: str, data: bytes) -> None:
            wait_until(publishers[topic].has_subscribers, f"a subscriber of {topic}")
            publishers[topic].publish([data])
            time.sleep(0.005)  # as sensors do, and not all at once: the program keeps the newest ten

        fuse_a_drive(start, "dds", tmp_path, send, lambda: [message_to_values(one) for one in heard])
