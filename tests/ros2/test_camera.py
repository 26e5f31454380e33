"""Camera programs on the topics of a real rclpy camera driver."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from needs import NO_OPENCV
from programs import Start

np = pytest.importorskip("numpy", reason=NO_OPENCV)
pytest.importorskip("cv2", reason=NO_OPENCV)

from judge import Judge, interface  # noqa: E402  # skips this module where there is no rclpy
from rclpy.qos import QoSProfile, ReliabilityPolicy  # noqa: E402
from rclpy.serialization import deserialize_message  # noqa: E402

from roverlink.demo.field import SIDE, parameters, render_film, write_field  # noqa: E402
from roverlink.runtime.core import cdr  # noqa: E402
from tests.vision.ros_images import FRAME, camera_info, image  # noqa: E402

_IMAGES, _INFO = "/camera/color/image_raw", "/camera/color/camera_info"


@pytest.fixture(params=["RELIABLE", "BEST_EFFORT"])
def driver(request: pytest.FixtureRequest, judge: Judge) -> Iterator[list[int]]:
    """An rclpy node that publishes a colour image and the camera's parameters; the stamps that it has given."""
    qos = QoSProfile(depth=5, reliability=ReliabilityPolicy[request.param])
    images = judge.node.create_publisher(interface("sensor_msgs/msg/Image"), _IMAGES, qos)
    infos = judge.node.create_publisher(interface("sensor_msgs/msg/CameraInfo"), _INFO, qos)
    (picture,) = render_film(1).frames
    stamps: list[int] = []
    stopped = threading.Event()

    def publish(publisher: Any, message: Any) -> None:
        publisher.publish(deserialize_message(cdr.encode(message), publisher.msg_type))

    def run() -> None:
        while not stopped.wait(0.05):
            stamps.append(1_700_000_000_000_000_000 + 33_333_333 * len(stamps))
            publish(images, image(picture[:, :, ::-1], "rgb8", stamps[-1]))
            publish(infos, camera_info(parameters(), stamps[-1]))

    thread = threading.Thread(target=run)
    thread.start()
    yield stamps
    stopped.set()
    thread.join()


def test_images_of_an_rclpy_node_are_tracked(driver: list[int], done: Start, middleware: str, tmp_path: Path) -> None:
    """Poses have the stamp and the frame of the image, with either QoS and either middleware."""
    write_field(tmp_path)
    words = ("--side", SIDE, "--landmarks", tmp_path / "landmarks.yaml", "--json", "--count", 3)
    # Not `none`: the middleware that receives is the one that would publish.
    code, output, errors = done(  # type: ignore[misc]
        "aruco", "track", f"topic:{_IMAGES}", *words, "--middleware", middleware
    )
    assert code == 0, errors
    views = [json.loads(line) for line in output.splitlines()]
    assert len(views) == 3
    for view in views:
        assert (view["frame_id"], view["stamp"] in driver) == (FRAME, True)
        assert np.linalg.norm(view["camera"]["position"] - render_film(1).truth[0].translation) < 0.01


def test_a_subscription_of_rclpy_follows_and_ends(judge: Judge, environment: dict[str, str], middleware: str) -> None:
    """Where the driver starts again with another QoS, the subscription follows; when it ends, the graph knows."""
    from polling import wait_until

    from roverlink.runtime.interfaces.sensor_msgs import CameraInfo
    from roverlink.runtime.middleware import NodeIdentity, open_middleware
    from roverlink.runtime.middleware.following import FollowingSubscription

    kind = interface("sensor_msgs/msg/CameraInfo")
    heard: list[Any] = []

    def take(_: Any, messages: Any) -> None:
        heard.extend(messages)

    with open_middleware(middleware, NodeIdentity("camera_reader")) as ours:
        following = FollowingSubscription(ours, _INFO, [CameraInfo], take, depth=5)
        for reliability in ("RELIABLE", "BEST_EFFORT", "RELIABLE"):
            publisher = judge.node.create_publisher(
                kind, _INFO, QoSProfile(depth=5, reliability=ReliabilityPolicy[reliability])
            )
            del heard[:]
            wait_until(_heard(following, publisher, kind, heard), f"a message with the QoS {reliability}")
            judge.node.destroy_publisher(publisher)
            wait_until(lambda: _INFO not in ours.topics(), "the end of the publisher")
        following.close()
        wait_until(lambda: not judge.node.count_subscribers(_INFO), "the end of the subscription")


def _heard(following: Any, publisher: Any, kind: Any, heard: list[Any]) -> Callable[[], bool]:
    def heard_one() -> bool:
        following.look()
        publisher.publish(kind())
        return bool(heard)

    return heard_one
