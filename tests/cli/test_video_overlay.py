"""What is drawn into sent images: detected objects, and the quality of the link that a bridge measures."""

from __future__ import annotations

import json
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from linked import linked_registry, write_project
from needs import NO_AV, NO_OPENCV, needs_dds
from node_in_memory import hear
from polling import wait_until
from programs import Start
from repeating import repeated

from roverlink.runtime import Qos
from roverlink.runtime.client import BlockingPeer
from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces import sensor_msgs, vision_msgs
from roverlink.runtime.middleware import NodeIdentity, open_middleware
from roverlink.simulation.bridge_host import BridgeProcess
from roverlink.simulation.peers import on_loopback
from roverlink.video.link_quality import LinkQualities, LinkQuality

cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
np = pytest.importorskip("numpy", reason=NO_OPENCV)
pytest.importorskip("av", reason=NO_AV)

from roverlink.video.overlay import link_text  # noqa: E402  # they need OpenCV
from roverlink.vision.objects.detected_objects import Box, TrackedObject  # noqa: E402
from roverlink.vision.ros.object_messages import detections_2d_of  # noqa: E402


@pytest.mark.slow
@needs_dds
def test_the_quality_of_the_link_is_that_of_the_bridge(tmp_path: Path) -> None:
    """By the address of the basestation, which answers the bridge's link messages."""
    registry = linked_registry()
    with ExitStack() as stack:
        peers = {
            peer.name: stack.enter_context(
                BlockingPeer.open(peer.name, registry=registry, local_address="127.0.0.1", local_port=0)
            )
            for peer in registry.peers
        }
        given = on_loopback(registry, {name: peers[name.peer].port for name in registry.ends})
        host = stack.enter_context(BridgeProcess(write_project(tmp_path), "dds", given))
        qualities = LinkQualities(
            stack.enter_context(open_middleware("dds", NodeIdentity("video"))), lambda: None, pytest.fail
        )
        for peer in peers.values():
            peer.direct_to("127.0.0.1", host.port)

        def measured() -> LinkQuality | None:
            for peer in peers.values():
                peer.arrived()
            quality = qualities.of("127.0.0.1")
            return quality if quality and quality.round_trip is not None else None

        quality = wait_until(measured, "the quality")
    assert quality is not None
    assert quality.loss == 0
    assert 0 <= (quality.round_trip or 0) < 60
    assert qualities.of("10.0.0.7") is None


def test_the_line_about_the_link_has_what_is_known() -> None:
    """The loss, and the round trip."""
    assert link_text(None) == "link: unknown"
    assert link_text(LinkQuality(0.125, None)) == "link: 12% lost"
    assert link_text(LinkQuality(0.0, 0.0234)) == "link: 0% lost, 23 ms"


@pytest.mark.slow
@needs_dds
def test_objects_and_the_link_are_drawn(start: Start, tmp_path: Path) -> None:
    """Boxes at their places in the images of the source, which are scaled afterwards; a line of text at the top."""
    cv2.imwrite(str(tmp_path / "0.png"), np.full((480, 640, 3), 128, np.uint8))
    receiver = start("video", "receive", "front=0", "--topic", "--middleware", "dds", "--no-page", "--json")
    port = json.loads(receiver.wait_for("streams", receiver.output))["streams"][0]["port"]
    words = ("--overlay", "objects,link", "--size", "320x240", "--bitrate", "4000", "--loop", "--middleware", "dds")
    start("video", "send", tmp_path, "--port", port, *words)
    with open_middleware("dds", NodeIdentity("tracker")) as node:
        arrived = hear(node, "/video/front/compressed", sensor_msgs.CompressedImage)
        objects = node.publisher("/objects/detections", vision_msgs.Detection2DArray, Qos())
        found = [TrackedObject(3, Box(200, 240, 300, 160), "rock", 0.9)]

        def picture() -> Any:
            return cv2.imdecode(np.frombuffer(arrived[-1].data, np.uint8), cv2.IMREAD_COLOR).astype(int) - 128

        def contrast(y: int, x: int) -> int:
            return int(np.abs(picture()[y, x]).max())

        with repeated(lambda _: objects.publish([cdr.encode(detections_2d_of(found, time.time_ns(), "front"))])):
            left, right, lower = (160, 100), (160, 250), (200, 175)
            wait_until(lambda: arrived and min(contrast(*edge) for edge in (left, right, lower)) > 40, "the box")
        assert contrast(160, 175) < 20  # inside
        assert np.abs(picture()[:12, :60]).max() > 60  # the text
        wait_until(lambda: contrast(*left) < 20, "the end of the box")
