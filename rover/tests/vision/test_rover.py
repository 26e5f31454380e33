"""The pose of a rover: its cameras' frames that belong together, and what goes to which ROS 2 topic."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any, NoReturn

import numpy as np
import pytest
from polling import wait_until
from roverkit.aruco.landmark_publisher import LandmarkPublisher
from roverkit.aruco.rover_pose_publisher import RoverFrames, RoverPosePublisher
from roverkit.aruco.rover_position_publisher import FUSED_S, position_publisher
from roverkit.aruco.tracker_declaration import POSITION
from roverkit.vision import Landmark, Landmarks, Pose
from roverkit.vision.frames import Frame
from roverkit.vision.localization.field_tracker import LandmarkResult
from roverkit.vision.localization.pose_from_landmarks import CameraDetections, FieldPose
from roverkit.vision.localization.rover_localizer import SLOP_NS, RoverLocalizer, RoverPose
from roverkit.vision.poses.pose import quaternion_of, rotation_of
from roverkit.vision.poses.transform_tree import TransformTree
from roverkit.vision.ros.transform_listener import TransformListener

from generated.interfaces.nav_msgs import Odometry
from generated.messages import BasestationRoverLocalization
from generated.registry import REGISTRY
from rover.bench.vision.contestants import camera_of
from rover.bench.vision.scenes import lens
from rover.tests.vision.ros_images import header
from rover.tests.vision.seen import FACING, camera_on_field, detection, view, wall
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import MiddlewareError
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import Time, geometry_msgs, tf2_msgs, vision_msgs
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware

_MS = 1_000_000
_S = 1_000_000_000
_AHEAD = np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])
_MOUNT = Pose(_AHEAD, np.array([0.3, 0.1, 0.4]))


class _Field:
    """A rover with two cameras that stands still."""

    def __init__(self) -> None:
        self._rng = np.random.default_rng(0)
        self.rover = camera_on_field(self._rng) @ _MOUNT.inverse()
        known = Landmarks("map", {number: Landmark(place) for number, place in wall().items()})
        self.localizer = RoverLocalizer(2, known)

    def see(self, camera: str, at_ms: int, *ids: int) -> RoverPose | None:
        """A camera sees some landmarks."""
        detections = view(self.rover @ _MOUNT, {number: wall()[number] for number in ids}, self._rng)
        return self.localizer.add(camera, at_ms * _MS, CameraDetections(detections, _MOUNT))


def _found(rover: RoverPose | None) -> tuple[int, set[object]] | None:
    return None if rover is None else (rover.stamp // _MS, set(rover.field_pose.used))


def test_frames_of_one_time_give_one_pose() -> None:
    """The pose has the landmarks of both cameras and the newer stamp; each frame is used once."""
    field = _Field()
    steps = [("front", 0, 1), ("left", 20, 2), ("front", 33, 1), ("left", 53, 2)]
    found = [_found(field.see(*step)) for step in steps]
    assert found == [None, (20, {1, 2}), None, (53, {1, 2})]


def test_a_camera_that_stops_delays_the_other_by_one_frame() -> None:
    """The pose is then from one camera; frames that are too far apart are not joined either."""
    field = _Field()
    steps = [("front", 0, 1), ("front", 33, 1), ("left", 33 + SLOP_NS // _MS + 1, 2), ("front", 200, 3)]
    found = [_found(field.see(*step)) for step in steps]
    assert found == [None, (0, {1}), (33, {1}), (84, {2})]


def test_a_frame_without_landmarks_or_mount_is_no_obstacle() -> None:
    """The other camera's frame gives the pose."""
    field = _Field()
    assert field.see("front", 0) is None
    assert _found(field.see("left", 5, 2)) == (5, {2})
    assert field.localizer.add("front", 33 * _MS, None) is None
    assert field.see("left", 38, 2) is None
    assert _found(field.see("left", 71, 1)) == (38, {2})


def _message(parent: str, child: str, pose: Pose, stamp: int = 0, turn: tuple[float, ...] = ()) -> bytes:
    quaternion = geometry_msgs.Quaternion(*(turn or quaternion_of(pose.rotation).tolist()))
    transform = geometry_msgs.Transform(geometry_msgs.Vector3(*pose.translation.tolist()), quaternion)
    return cdr.encode(tf2_msgs.TFMessage([geometry_msgs.TransformStamped(header(stamp, parent), child, transform)]))


def _topic(name: str) -> str:
    return f"/{name.lstrip('/')}"


@pytest.fixture
def said() -> list[str]:
    """What the user is told."""
    return []


@pytest.fixture
def node() -> Iterator[MemoryMiddleware]:
    """A node in a graph."""
    with MemoryMiddleware(Graph()) as node:
        yield node


def _heard(node: MemoryMiddleware, topic: str, kind: type[Message], qos: Qos = Qos()) -> list[Any]:  # noqa: B008
    """The messages that will have come on a topic."""
    heard: list[Any] = []
    node.subscribe(topic, kind, qos, lambda many: heard.extend(cdr.decode(kind, one) for one in many))
    return heard


def test_transforms_of_ros_2_are_kept(node: MemoryMiddleware, said: list[str]) -> None:
    """Static and moving ones make one tree; one that is none is told once and ignored."""
    listener = TransformListener(node, _topic, said.append)
    moving = node.publisher("/tf", tf2_msgs.TFMessage, Qos())
    static = node.publisher("/tf_static", tf2_msgs.TFMessage, Qos(durability="transient_local"))
    turned = Pose(rotation_of(np.array([0.1, -0.2, 0.3])), np.array([1.0, 2, 3]))
    moving.publish([_message("odom", "base_link", turned, 5 * _S)])
    static.publish([_message("/base_link", "/camera", _MOUNT)])
    for _ in range(2):
        moving.publish([_message("odom", "base_link", turned, 5 * _S, turn=(0, 0, 0, 0)), b"\0\1\0\0"])
    found = listener.tree.look_up("odom", "camera", 5 * _S)
    assert found.translation == pytest.approx((turned @ _MOUNT).translation)
    assert found.rotation == pytest.approx((turned @ _MOUNT).rotation)
    assert said == ["ignoring transforms: the transform from 'base_link' to 'odom' is not one"]


def test_the_rover_s_pose_and_the_transform_of_its_odometry(node: MemoryMiddleware, said: list[str]) -> None:
    """Map to odom and odom to base are together the pose; without odometry there is no transform, and one message."""
    tree = TransformTree()
    poses = _heard(node, "/aruco/pose", geometry_msgs.PoseWithCovarianceStamped)
    transforms = _heard(node, "/tf", tf2_msgs.TFMessage)
    publishing = RoverPosePublisher(node, RoverFrames("base_link", "odom"), tree, _topic, said.append)
    pose = Pose(rotation_of(np.array([0, 0, 0.5])), np.array([4.0, 5, 0.1]))
    rover = RoverPose(7 * _S, FieldPose("map", pose, np.eye(6) * 0.01, (1, 2), ()))
    for _ in range(3):
        publishing.publish(rover)
    assert (len(poses), transforms) == (3, [])
    assert said == [
        "no transform from 'map' to 'odom' is published: no transforms connect 'odom' with 'base_link'; "
        "no transforms have come"
    ]
    message = poses[0]
    assert (message.header.frame_id, message.header.stamp, message.pose.pose.position.x) == ("map", Time(7, 0), 4.0)
    tree.add("odom", "base_link", 7 * _S, Pose(rotation_of(np.array([0, 0, -0.2])), np.array([1.0, -2, 0])))
    publishing.publish(rover)
    ((sent,),) = (one.transforms for one in transforms)
    assert (sent.header.frame_id, sent.child_frame_id, sent.header.stamp) == ("map", "odom", Time(7, 0))
    way = sent.transform.translation
    tree.add("map", "odom", 7 * _S, Pose(rotation_of(np.array([0, 0, 0.7])), np.array([way.x, way.y, way.z])))
    assert tree.look_up("map", "base_link", 7 * _S).translation == pytest.approx(pose.translation)


def test_markers_that_share_a_number_are_in_the_detections_alone(node: MemoryMiddleware) -> None:
    """A frame on /tf and a topic belong to one marker. In the detections each has its pose, and no id as an object."""
    rng = np.random.default_rng(0)
    places = [(7, -0.5, True), (7, 0.5, True), (9, 0.0, False)]
    seen = tuple(
        detection(number, Pose(FACING, np.array([x, 0, 2.0])), rng, shared=shared) for number, x, shared in places
    )
    transforms, detections = _heard(node, "/tf", tf2_msgs.TFMessage), _heard(node, "/aruco/detections", _DETECTIONS)
    poses = [_heard(node, f"/aruco/aruco_{number}/pose", geometry_msgs.PoseWithCovarianceStamped) for number in (7, 9)]
    publishing = LandmarkPublisher(node, "aruco_", _topic)
    publishing.publish(LandmarkResult(Frame(np.zeros((480, 640), np.uint8), 5, 0, "eye"), camera_of(lens()), seen))
    assert list(map(len, poses)) == [0, 1]
    assert [one.child_frame_id for one in transforms[0].transforms] == ["aruco_9"]
    found = [
        (one.id, one.results[0].hypothesis.class_id, round(one.bbox.center.position.x, 2))
        for one in detections[0].detections
    ]
    assert found == [("", "7", -0.5), ("", "7", 0.5), ("aruco_9", "9", 0)]


def test_a_message_that_ros_2_lacks_is_left_out(node: MemoryMiddleware, monkeypatch: pytest.MonkeyPatch) -> None:
    """With rclpy and a package of messages that is not built, tracking goes on without the position, and says so."""
    said: list[str] = []

    def missing(*_: object, **__: object) -> NoReturn:
        raise MiddlewareError("comms/msg/BasestationRoverLocalization is not installed")

    monkeypatch.setattr(node, "publisher", missing)
    monkeypatch.setattr(node, "subscribe", missing)
    position_publisher(node, REGISTRY, _topic, said.append)(_POSITION)
    assert any(f"cannot publish on /{_ROUTE.topic}: comms/msg" in text for text in said)


_DETECTIONS = vision_msgs.Detection3DArray
_POSITION = np.array([1.5, -2.0, 0.25])
_ROUTE = REGISTRY.by_name[POSITION.row].route


@pytest.mark.slow
def test_a_fused_position_holds_the_one_of_the_markers_back(node: MemoryMiddleware) -> None:
    """Nothing comes on the row's topic after a message on its extra topic, and after a time without one it does."""
    heard = _heard(node, f"/{_ROUTE.topic}", BasestationRoverLocalization, _ROUTE.qos)
    fused = node.publisher("/odometry/global", Odometry, _ROUTE.qos)
    publish = position_publisher(node, REGISTRY, _topic)
    fused.publish([cdr.encode(Odometry())])
    start = time.monotonic()
    publish(_POSITION)
    assert heard == []
    wait_until(lambda: publish(_POSITION) or heard, "the position of the markers")
    assert time.monotonic() - start > FUSED_S
    assert heard[0] == BasestationRoverLocalization(x=1.5, y=-2.0, z=0.25)
