"""The pose of a rover: cameras of a file or on topics, mounts from the file or /tf_static, and what is published."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from needs import NO_OPENCV, needs_dds
from node_in_memory import hear
from polling import wait_until
from programs import Start

from roverlink.__main__ import main
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware import Middleware, NodeIdentity, open_middleware

cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
np = pytest.importorskip("numpy", reason=NO_OPENCV)

from driven_film import Field, lines  # noqa: E402  # they need OpenCV
from roverkit.vision.frames import TopicSets  # noqa: E402

from generated.messages import BasestationRoverLocalization  # noqa: E402
from rover.bench.vision.circling_film import rover_position  # noqa: E402
from rover.tests.vision import board_frames  # noqa: E402
from rover.tests.vision.d435i import BEGAN_NS, COLOUR, PERIOD_NS, TOPICS, RenderedD435i  # noqa: E402
from rover.tests.vision.ros_images import FRAME, image, publishing  # noqa: E402
from roverlink.runtime.interfaces import geometry_msgs, tf2_msgs, vision_msgs  # noqa: E402
from roverlink.runtime.interfaces.sensor_msgs import Image  # noqa: E402
from roverlink.runtime.ros_time.headers import stamp_of  # noqa: E402

_FRAMES = 3


@pytest.fixture
def field(tmp_path: Path) -> Field:
    """A short drive, and a file of cameras with the drive."""
    return Field.written(tmp_path, _FRAMES)


def _words(field: Field, *more: object) -> list[str]:
    return field.words(*more, source=field.folder / "cameras.yaml")


def _with_a_second_camera(field: Field, mount: str = "[0, 0, 0.6]") -> None:
    text = (field.folder / "cameras.yaml").read_text()
    (field.folder / "cameras.yaml").write_text(
        f"{text}  left:\n    source: frames\n    rate: 10\n    parameters: camera.yml\n    frame: left_eye\n"
        f"    mount: {{position: {mount}, rpy: [0, 0, 0]}}\n"
    )


@pytest.mark.slow
def test_the_mount_of_a_camera_gives_the_rover_s_pose(field: Field, capsys: pytest.CaptureFixture[str]) -> None:
    """Each frame says where the camera and the rover are; a file of one camera is enough."""
    views, _ = lines(capsys, _words(field, "--json"))
    assert len(views) == _FRAMES
    for view in views:
        truth = field.film.truth[view["frame"]]
        assert (view["name"], view["frame_id"]) == ("front", "front_optical_frame")
        assert np.linalg.norm(view["camera"]["position"] - truth.translation) < 0.01
        assert np.linalg.norm(view["rover"]["position"] - rover_position(truth)) < 0.01
        assert (view["rover"]["stamp"], view["rover"]["frame"]) == (view["stamp"], "map")


@pytest.mark.slow
def test_cameras_that_contradict_each_other_give_no_pose(field: Field, capsys: pytest.CaptureFixture[str]) -> None:
    """If a mount is wrong, it is unknown which one: this is told once. Each camera has its film, named after it."""
    _with_a_second_camera(field, "[0, 0.3, 0.6]")
    views, told = lines(capsys, _words(field, "--json", "--save", field.folder / "seen.avi"))
    assert all("position" not in view["rover"] for view in views[1::2])
    assert told.count("contradict each other; there is no pose until most of them agree") == 1
    for name in ("front", "left"):
        capture = cv2.VideoCapture(str(field.folder / f"seen_{name}.avi"))
        assert sum(capture.grab() for _ in range(_FRAMES + 1)) == _FRAMES


@pytest.mark.slow
def test_a_camera_without_a_mount_is_told(field: Field, capsys: pytest.CaptureFixture[str]) -> None:
    """Where no ROS 2 could give it, the rover's pose comes from the other cameras, without delay."""
    _with_a_second_camera(field)
    whole = (field.folder / "cameras.yaml").read_text()
    (field.folder / "cameras.yaml").write_text(whole[: whole.rindex("    mount:")])
    views, told = lines(capsys, _words(field, "--json"))
    assert "camera left has no mount, so the pose of the rover is computed without it; add 'mount' to" in told
    assert [view["rover"]["stamp"] for view in views if "rover" in view] == [view["stamp"] for view in views[::2]]


@contextmanager
def _driver(node: Middleware, camera: RenderedD435i) -> Iterator[None]:
    """A driver that publishes images, and the rover's description."""
    static = node.publisher("/tf_static", tf2_msgs.TFMessage, Qos(depth=1, durability="transient_local"))
    static.publish([cdr.encode(camera.transforms)])
    with publishing(node, TOPICS, camera.messages):
        yield


@pytest.mark.slow
@needs_dds
def test_a_d435i_says_where_base_link_is(field: Field) -> None:
    """The pose comes from images over DDS and the transforms on /tf_static; the basestation gets the same."""
    camera = RenderedD435i(8)
    with open_middleware("dds", NodeIdentity("driver")) as node, _driver(node, camera):
        poses = hear(node, "/aruco/pose", geometry_msgs.PoseWithCovarianceStamped, Qos(depth=100))
        positions = hear(node, "/rover_localization", BasestationRoverLocalization, Qos(depth=100))
        assert main(field.words("--middleware", "dds", "--count", 30, source=f"topic:{COLOUR}")) == 0
        wait_until(lambda: len(poses) >= 20 and positions, "poses of the rover")
        with TopicSets(node, [*TOPICS], print) as sets:
            colour, depth, _ = next(iter(sets))
    inside = []
    for one in poses:
        place = one.pose.pose.position
        assert one.header.frame_id == "map"
        inside.append(camera.is_inside(stamp_of(one.header), (place.x, place.y, place.z), one.pose.covariance))
    assert np.mean(inside) > 0.8
    found = {(one.pose.pose.position.x, one.pose.pose.position.y) for one in poses}
    assert any(np.hypot(*(np.subtract((place.x, place.y), one))) < 1e-5 for place in positions for one in found)
    assert colour.stamp == depth.stamp
    assert depth.pixels.min() < 3500 < depth.pixels.max()


@pytest.mark.slow
@needs_dds
@pytest.mark.parametrize("given", [(), ("--camera-frame", "eye")])
def test_ros_2_hears_the_stamp_and_frame_of_the_image(field: Field, given: tuple[str, ...]) -> None:
    """They are on /tf and in the detections, unless the frame is given; names follow the ROS arguments."""
    ros = ("--ros-args", "-r", "__ns:=/camera", "-r", "picture:=camera/color/image_raw")
    with open_middleware("dds", NodeIdentity("driver")) as node, _driver(node, RenderedD435i(_FRAMES)):
        transforms = hear(node, "/tf", tf2_msgs.TFMessage)
        detections = hear(node, "/camera/aruco/detections", vision_msgs.Detection3DArray)
        words = ("--middleware", "dds", "--count", 10, *given, *ros)
        assert main(field.words(*words, source="topic:picture")) == 0
        wait_until(lambda: transforms and detections, "both topics")
    headers = [one.header for message in transforms for one in message.transforms]
    for header in (*headers, *(message.header for message in detections)):
        assert header.frame_id == (given[-1] if given else FRAME)
        assert (stamp_of(header) - BEGAN_NS) % PERIOD_NS == 0


@pytest.mark.slow
@needs_dds
def test_a_camera_is_calibrated_over_a_topic(start: Start, tmp_path: Path) -> None:
    """Views of the board are taken from the topic."""
    picture = board_frames.frame((0, 0), (0.5, 0.5), 0.36)
    program = start("aruco", "calibrate", f"topic:{COLOUR}", "--json", "--out", tmp_path / "camera.yml")
    with (
        open_middleware("dds", NodeIdentity("driver")) as node,
        publishing(node, {COLOUR: Image}, lambda _: [image(picture, "mono8", time.time_ns())]),
    ):
        program.wait_for('"view"', program.output)
        assert program.interrupt() == 1  # one view is not enough
