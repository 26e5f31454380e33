"""The programs of roverkit over zenoh: another node of the graph sees their topics, and exchanges messages."""

from __future__ import annotations

from pathlib import Path

import pytest
from needs import NO_AV, NO_GTSAM, NO_OPENCV
from polling import wait_until
from programs import Start

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("gtsam", reason=NO_GTSAM)
pytest.importorskip("av", reason=NO_AV)

from generated.registry import REGISTRY
from rover.tests.driving.simulated_tracker import write_field
from roverlink.runtime import Qos
from roverlink.runtime.interfaces.nav_msgs import Odometry
from roverlink.runtime.interfaces.sensor_msgs import Image
from roverlink.runtime.middleware import NodeIdentity, open_middleware

_FOLLOWED = ("/image", False)
_PROGRAMS = (
    ("aruco calibrate topic:/image --square 0.02 --marker 0.015", *_FOLLOWED, "/camera_calibration"),
    ("aruco track topic:/image --side 0.15", *_FOLLOWED, "/aruco_tracker"),
    ("drive", "/drive/state", True, "/drive"),
    ("fuse --landmarks {landmarks}", "/odometry/global", True, "/fusion"),
    ("objects select", "/selected_object/state", True, "/object_selection"),
    ("odometry", "/odometry/wheel", True, "/odometry"),
    ("rocks measure /color/image_raw", "/rock_measure_result", True, "/rock_measurement"),
    ("video send topic:/image --host 127.0.0.1", *_FOLLOWED, "/video_sender"),
)
"""Words of a command; a topic that it publishes (true) or subscribes to, and its node."""


@pytest.mark.slow
@pytest.mark.usefixtures("zenoh_router")
def test_programs_work_over_zenoh(start: Start, tmp_path: Path) -> None:
    """Each opens a topic of its declaration, or follows the camera's publisher; reports become wheel odometry."""
    landmarks, _ = write_field(tmp_path, "front")
    progress, heard = REGISTRY.by_name["drive_progress"], list[bytes]()
    with open_middleware("zenoh", NodeIdentity("rover")) as node:
        node.publisher("/image", Image, Qos("best_effort"))
        reports = node.publisher("/drive_progress", progress.message_type, progress.route.qos)
        node.subscribe("/odometry/wheel", Odometry, Qos(), heard.extend)
        for words, *_ in _PROGRAMS:
            start(*words.format(landmarks=landmarks).split(), "--middleware", "zenoh")
        for words, topic, publishing, name in _PROGRAMS:
            wait_until(lambda: name in [one.node for one in node.endpoints(topic, publishing)], words)  # noqa: B023
        message = [progress.to_cdr(progress.payload_type())]
        wait_until(lambda: reports.publish(message) and heard, "wheel odometry")
