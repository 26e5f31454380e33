"""Camera programs on the topics of a real rclpy camera driver."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from needs import NO_OPENCV
from polling import wait_until
from programs import Start

np = pytest.importorskip("numpy", reason=NO_OPENCV)
pytest.importorskip("cv2", reason=NO_OPENCV)

from judge import Judge, interface, typed  # noqa: E402  # skips this module where there is no rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy  # noqa: E402
from roverkit.demo.field import SIDE, parameters, write_field  # noqa: E402

from rover.bench.vision.circling_film import render_film  # noqa: E402
from rover.tests.vision.d435i import COLOUR, TOPICS, RenderedD435i  # noqa: E402
from rover.tests.vision.ros_images import FRAME, camera_info, image  # noqa: E402
from roverlink.runtime.interfaces.builtin_interfaces import Time  # noqa: E402
from roverlink.runtime.interfaces.rosgraph_msgs import Clock  # noqa: E402
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo, Image  # noqa: E402

_IMAGES, _INFO = "/camera/color/image_raw", "/camera/color/camera_info"


@pytest.mark.parametrize("reliability", ["RELIABLE", "BEST_EFFORT"])
def test_images_of_an_rclpy_node_are_tracked(
    judge: Judge, done: Start, middleware: str, tmp_path: Path, reliability: str
) -> None:
    """Poses have the stamp and the frame of the image, with either QoS and either middleware."""
    (picture,) = render_film(1).frames
    stamps: list[int] = []

    def messages(number: int) -> tuple[Image, CameraInfo]:
        stamps.append(1_700_000_000_000_000_000 + 33_333_333 * number)
        return image(picture[:, :, ::-1], "rgb8", stamps[-1]), camera_info(parameters(), stamps[-1])

    write_field(tmp_path)
    words = ("--side", SIDE, "--landmarks", tmp_path / "landmarks.yaml", "--json", "--count", 6)
    qos = QoSProfile(depth=5, reliability=ReliabilityPolicy[reliability])
    with judge.publishing({_IMAGES: Image, _INFO: CameraInfo}, messages, qos):
        # Not `none`: the middleware that receives is the one that would publish.
        code, output, errors = done(  # type: ignore[misc]
            "aruco", "track", f"topic:{_IMAGES}", *words, "--middleware", middleware
        )
    assert code == 0, errors
    views = [json.loads(line) for line in output.splitlines()]
    assert len(views) == 6
    assert all((view["frame_id"], view["stamp"] in stamps) == (FRAME, True) for view in views)
    located = [view["camera"]["position"] for view in views if "camera" in view]  # once the parameters have come
    assert located
    assert all(np.linalg.norm(one - render_film(1).truth[0].translation) < 0.01 for one in located)


def test_a_d435i_of_rclpy_says_where_base_link_is(judge: Judge, done: Start, middleware: str, tmp_path: Path) -> None:
    """Images and transforms come from an rclpy node; the true pose is inside the 95 % ellipsoid that it hears."""
    camera = RenderedD435i(8)
    write_field(tmp_path)
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    judge.node.create_publisher(interface("tf2_msgs/msg/TFMessage"), "/tf_static", latched).publish(
        typed(camera.transforms)
    )
    heard = judge.hear("/aruco/pose", "geometry_msgs/msg/PoseWithCovarianceStamped", 100)
    words = ("--side", SIDE, "--landmarks", tmp_path / "landmarks.yaml", "--count", 24, "--middleware", middleware)
    with judge.publishing(TOPICS, camera.messages):
        code, _, errors = done("aruco", "track", f"topic:{COLOUR}", *words)  # type: ignore[misc]
    assert code == 0, errors
    wait_until(lambda: len(heard.values) >= 12, "poses of the rover")
    inside = []
    for one in heard.values:
        stamp, place = one["header"]["stamp"], one["pose"]["pose"]["position"]
        found = (place["x"], place["y"], place["z"])
        inside.append(camera.is_inside(stamp["sec"] * 10**9 + stamp["nanosec"], found, one["pose"]["covariance"]))
    assert {one["header"]["frame_id"] for one in heard.values} == {"map"}
    assert np.mean(inside) > 0.8


def test_parameters_of_the_tracker_change_while_it_runs(judge: Judge, start: Start, tmp_path: Path) -> None:
    """Another dictionary, landmarks, another side, as `ros2 param set` does it; a refusal has its reason."""
    camera = RenderedD435i(1)
    write_field(tmp_path)
    words = ("--side", SIDE, "--dictionary", "DICT_4X4_50", "--json", "--middleware", "rclpy")

    def set_parameter(name: str, value: Any) -> Any:
        return judge.set_parameters("/aruco_tracker", **{name: value})[0]

    with judge.publishing(TOPICS, camera.messages):
        tracker = start("aruco", "track", f"topic:{COLOUR}", *words)

        def last() -> Any:
            return json.loads(tracker.output[-1])

        wait_until(lambda: tracker.output, "a view")
        assert last()["markers"] == []
        refused = set_parameter("dictionary", "DICT_5X5_25")
        assert (refused.successful, "did you mean 'DICT_5X5_250'" in refused.reason) == (False, True)
        assert set_parameter("dictionary", "DICT_5X5_250").successful
        wait_until(lambda: len(last()["markers"]) == 4, "the markers of the other dictionary")
        assert "camera" not in last()
        assert set_parameter("landmarks", str(tmp_path / "landmarks.yaml")).successful
        wait_until(lambda: "camera" in last(), "the pose of the camera")
        distance = last()["markers"][0]["position"][2]
        assert set_parameter("side", 2 * SIDE).successful
        wait_until(lambda: last()["markers"][0]["position"][2] > 1.9 * distance, "poses with the other side")
        assert not set_parameter("use_sim_time", True).successful
        assert tracker.interrupt() == 0


def test_the_time_of_a_simulation_is_used(judge: Judge, start: Start, middleware: str, tmp_path: Path) -> None:
    """With `use_sim_time`, images without stamps get the time on /clock, and rclpy nodes hear it in the results."""
    (picture,) = render_film(1).frames
    write_field(tmp_path)
    heard = judge.hear("/aruco/camera_info", "sensor_msgs/msg/CameraInfo")
    words = ("--side", SIDE, "--parameters", tmp_path / "camera.yml", "--middleware", middleware)

    def messages(number: int) -> tuple[Image, Clock]:
        return image(picture[:, :, ::-1], "rgb8", 0), Clock(Time(7, number))

    with judge.publishing({COLOUR: Image, "/clock": Clock}, messages):
        tracker = start("aruco", "track", f"topic:{COLOUR}", *words, "--ros-args", "-p", "use_sim_time:=true")
        wait_until(lambda: len(heard.values) > 2, "results")
        assert tracker.interrupt() == 0
    assert {one["header"]["stamp"]["sec"] for one in heard.values} == {7}
    nanoseconds = [one["header"]["stamp"]["nanosec"] for one in heard.values]
    assert 0 < nanoseconds[0] < nanoseconds[-1]


def test_a_subscription_of_rclpy_follows_and_ends(judge: Judge, environment: dict[str, str], middleware: str) -> None:
    """Where the driver starts again with another QoS, the subscription follows; when it ends, the graph knows."""
    from roverlink.runtime.middleware import NodeIdentity, open_middleware
    from roverlink.runtime.middleware.following import FollowingSubscription

    kind = interface("sensor_msgs/msg/CameraInfo")
    heard: list[Any] = []
    with open_middleware(middleware, NodeIdentity("camera_reader")) as ours:
        following = FollowingSubscription(
            ours, _INFO, [CameraInfo], lambda _, messages: heard.extend(messages), depth=5
        )
        for reliability in ("RELIABLE", "BEST_EFFORT", "RELIABLE"):
            qos = QoSProfile(depth=5, reliability=ReliabilityPolicy[reliability])
            publisher = judge.node.create_publisher(kind, _INFO, qos)
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
