"""Camera commands on ROS 2 topics: images over real DDS, as a camera driver publishes them."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest
from needs import NO_OPENCV, needs_dds
from node_in_memory import hear
from polling import wait_until
from programs import Start
from repeating import repeated

from roverlink.__main__ import main
from roverlink.runtime import Qos
from roverlink.runtime.middleware import Middleware, NodeIdentity, open_middleware

cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
np = pytest.importorskip("numpy", reason=NO_OPENCV)

from roverkit.demo.field import SIDE, parameters, write_field  # noqa: E402

from rover.bench.vision.circling_film import Film, render_film  # noqa: E402  # they need OpenCV
from rover.tests.vision import board_frames  # noqa: E402
from rover.tests.vision.ros_images import FRAME, Camera, camera_info, image  # noqa: E402
from roverlink.runtime.interfaces import sensor_msgs, tf2_msgs, vision_msgs  # noqa: E402

pytestmark = needs_dds

_FRAMES = 3
_PERIOD = 33_333_333
_BEGAN = 1_700_000_000_000_000_000
_IMAGES, _INFO = "/camera/color/image_raw", "/camera/color/camera_info"


@pytest.fixture(scope="module")
def film() -> Film:
    """A short drive."""
    return render_film(_FRAMES)


@pytest.fixture
def words(tmp_path: Path) -> list[str]:
    """The command line that tracks the drive with the parameters of the camera driver."""
    write_field(tmp_path)
    landmarks = str(tmp_path / "landmarks.yaml")
    return ["aruco", "track", f"topic:{_IMAGES}", "--side", str(SIDE), "--landmarks", landmarks]


@contextmanager
def _driving(
    film: Film, qos: Qos = Qos(depth=5), info: Any = None, *, grey: bool = False  # noqa: B008
) -> Iterator[Middleware]:
    """A camera driver that publishes the drive: the stamp of a frame says which one it is."""
    with ExitStack() as held:
        node = held.enter_context(open_middleware("dds", NodeIdentity("driver")))
        images, infos = Camera(node, _IMAGES, qos=qos), Camera(node, _INFO, sensor_msgs.CameraInfo, qos)

        def publish(number: int) -> None:
            stamp = _BEGAN + _PERIOD * number
            picture = film.frames[number % _FRAMES]
            images.publish(
                image(picture[:, :, 0], "mono8", stamp, padding=3) if grey else image(picture, "bgr8", stamp)
            )
            infos.publish(info or camera_info(parameters(), stamp))

        held.enter_context(repeated(publish))
        yield node


def _off(film: Film, view: dict[str, Any]) -> float:
    """Metres from where the camera was found to where it was."""
    number, rest = divmod(view["stamp"] - _BEGAN, _PERIOD)
    assert not rest
    truth = film.truth[number % _FRAMES].translation
    return float(np.linalg.norm(truth - view["camera"]["position"]))


@pytest.mark.slow
@pytest.mark.parametrize("reliability", ["reliable", "best_effort"])
def test_poses_have_the_stamp_and_frame_of_their_image(
    film: Film, words: list[str], capsys: pytest.CaptureFixture[str], reliability: str
) -> None:
    """Images of either QoS are tracked at their true places, with the parameters of the driver's CameraInfo."""
    with _driving(film, Qos(reliability, depth=5)):
        assert main([*words, "--json", "--count", "4"]) == 0
    told = capsys.readouterr()
    views = [json.loads(line) for line in told.out.splitlines()]
    assert len(views) == 4
    for view in views:
        assert view["frame_id"] == FRAME
        assert {one["id"] for one in view["markers"]} <= {7, 8, 9, 10}  # the drive begins again every third frame
        assert _off(film, view) < 0.01
    assert f"camera parameters: from {_INFO}" in told.err


@pytest.mark.slow
@pytest.mark.parametrize("given", [(), ("--camera-frame", "eye")])
def test_ros_2_hears_the_stamp_and_frame_of_the_image(film: Film, words: list[str], given: tuple[str, ...]) -> None:
    """They are on /tf and in the detections, unless the frame is given; names follow the ROS arguments."""
    topics: dict[str, Any] = {"/tf": tf2_msgs.TFMessage, "/camera/aruco/detections": vision_msgs.Detection3DArray}
    words[2] = "topic:picture"
    ros = ("--ros-args", "-r", "__ns:=/camera", "-r", "picture:=color/image_raw")
    with _driving(film) as node:
        heard = {topic: hear(node, topic, kind) for topic, kind in topics.items()}
        assert main([*words, "--middleware", "dds", "--count", "10", *given, *ros]) == 0
        wait_until(lambda: all(heard.values()), "both topics")
    headers = [one.header for message in heard["/tf"] for one in message.transforms]
    for header in (*headers, *(message.header for message in heard["/camera/aruco/detections"])):
        assert header.frame_id == (given[-1] if given else FRAME)
        assert (header.stamp.sec * 10**9 + header.stamp.nanosec - _BEGAN) % _PERIOD == 0


@pytest.mark.slow
def test_a_camera_is_calibrated_over_a_topic(start: Start, tmp_path: Path) -> None:
    """Views of the board are taken from the topic."""
    picture = board_frames.frame((0, 0), (0.5, 0.5), 0.36)
    program = start("aruco", "calibrate", f"topic:{_IMAGES}", "--json", "--out", tmp_path / "camera.yml")
    with open_middleware("dds", NodeIdentity("driver")) as node:
        camera = Camera(node, _IMAGES)
        with repeated(lambda _: camera.publish(image(picture, "mono8", time.time_ns()))):
            program.wait_for('"view"', program.output)
            assert program.interrupt() == 1  # one view is not enough
