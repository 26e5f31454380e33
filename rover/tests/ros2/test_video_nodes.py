"""Streams of video that a real ROS 2 changes, and images of an rclpy camera driver that are sent."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from needs import NO_AV, NO_OPENCV
from polling import wait_until
from programs import Start

np = pytest.importorskip("numpy", reason=NO_OPENCV)
cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("av", reason=NO_AV)

from judge import Judge, interface  # noqa: E402  # skips this module where there is no rclpy

from rover.tests.vision.ros_images import image  # noqa: E402
from roverlink.runtime.interfaces.sensor_msgs import Image  # noqa: E402


@pytest.fixture
def images(tmp_path: Path) -> Path:
    """A folder with an image."""
    folder = tmp_path / "images"
    folder.mkdir()
    cv2.imwrite(str(folder / "0.png"), np.full((48, 64, 3), 90, np.uint8))
    return folder


@pytest.mark.parametrize("setter", ["dds", "rclpy"])
def test_streams_are_changed_through_either_middleware(
    judge: Judge, start: Start, done: Start, middleware: str, setter: str, images: Path
) -> None:
    """`roverlink video set` reaches a sender with another middleware; rclpy knows the new value, and sets others."""
    sender = start("video", "send", images, "--loop", "--middleware", middleware)
    sender.wait_for("video: images go to 127.0.0.1:4500")
    words = ("video", "set", "--middleware", setter)
    code, output, _ = done(*words, "video.bitrate=500", "video.size=32x24")  # type: ignore[misc]
    assert (code, output.splitlines()) == (0, ['video.size: "32x24"', "video.bitrate: 500.0"])
    sender.wait_for("parameter video.bitrate is now 500.0 (it was 1000.0)")
    code, _, errors = done(*words, "video.rate=0")  # type: ignore[misc]
    assert (code, errors) == (2, "roverlink: stream video: the rate is 0; it must be from 0.1 to 240 images a second")
    if middleware == "rclpy":
        get = "rcl_interfaces/srv/GetParameters"
        names = ["video.bitrate", "video.rate"]
        values = judge.call("/video_sender/get_parameters", get, interface(get).Request(names=names)).values
        assert [value.double_value for value in values] == [500.0, 30.0]
        assert judge.set_parameters("/video_sender", **{"video.running": False})[0].successful
        code, output, _ = done(*words, "--json")  # type: ignore[misc]
        stream = json.loads(output)["video"]
        assert (code, stream["running"], stream["bitrate"]) == (0, False, 500.0)


def test_images_of_an_rclpy_node_arrive(judge: Judge, start: Start, middleware: str) -> None:
    """From its topic, over RTP, to the topic of the receiver, with the stamp of the camera."""
    receiver = start("video", "receive", "front=0", "--topic", "--middleware", middleware, "--page", "0", "--json")
    receiver.wait_for("page: ")
    port = json.loads(receiver.wait_for("port", receiver.output))["streams"][0]["port"]
    start("video", "send", "topic:/camera", "--port", port, "--middleware", middleware)
    heard = judge.hear("/video/front/compressed", "sensor_msgs/msg/CompressedImage")
    pixels = np.full((48, 64, 3), 90, np.uint8)

    def messages(number: int) -> tuple[Image]:
        return (image(pixels, stamp=7_000_000_000 + 40_000_000 * number),)

    with judge.publishing({"/camera": Image}, messages):
        wait_until(lambda: heard.values, "an image")
    stamp = heard.values[0]["header"]["stamp"]
    assert stamp["sec"] >= 7
    assert stamp["nanosec"] % 40_000_000 == 0
