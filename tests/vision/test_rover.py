"""The pose of a rover: its cameras' frames that belong together, the file of its cameras, and ROS 2's transforms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.interfaces import Time, geometry_msgs, tf2_msgs
from roverlink.runtime.interfaces.std_msgs import Header
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.vision import Landmark, Landmarks, Pose
from roverlink.vision.camera.cameras_file import read_cameras
from roverlink.vision.field.localization import FieldPose, Shot
from roverlink.vision.field.rover import SLOP_NS, RoverLocalizer, RoverPose
from roverlink.vision.poses.pose import quaternion_of, rotation_of
from roverlink.vision.poses.transform_tree import TransformTree
from roverlink.vision.ros.rover_pose import RoverFrames, RoverPublishing
from roverlink.vision.ros.transform_listener import TransformListener
from tests.vision.seen import camera_on_field, view, wall

_MS = 1_000_000
_S = 1_000_000_000
_AHEAD = np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])
_MOUNT = Pose(_AHEAD, np.array([0.3, 0.1, 0.4]))


# --- frames that belong together ---------------------------------------------------------------------------------


class _Field:
    """A rover with two cameras that stands still."""

    def __init__(self) -> None:
        self._rng = np.random.default_rng(0)
        self.rover = camera_on_field(self._rng) @ _MOUNT.inverse()
        known = Landmarks("map", {number: Landmark(place) for number, place in wall().items()})
        self.localizer = RoverLocalizer(2, known)

    def see(self, camera: str, at_ms: int, *ids: int) -> RoverPose | None:
        """A camera sees some landmarks."""
        sightings = view(self.rover @ _MOUNT, {number: wall()[number] for number in ids}, self._rng)
        return self.localizer.add(camera, at_ms * _MS, Shot(sightings, _MOUNT))


def _found(rover: RoverPose | None) -> tuple[int, set[object]] | None:
    return None if rover is None else (rover.stamp // _MS, set(rover.place.used))


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


# --- cameras.yaml -------------------------------------------------------------------------------------------------

_CAMERAS = """
cameras:
  front:
    source: topic:/camera/image_raw
    mount: {position: [0.3, 0, 0.45], rpy: [0, 90, 0]}
  left:
    source: 2
    parameters: left.yml
    frame: left_optical
    mount: {position: [0, 0.25, 0.5], rpy: [0, 0, 90]}
  film:
    source: drive.mp4
"""


def test_cameras_are_read_from_a_file(tmp_path: Path) -> None:
    """Mounts turn body axes to optical ones; files are beside the file."""
    (tmp_path / "cameras.yaml").write_text(_CAMERAS)
    (tmp_path / "drive.mp4").touch()
    front, left, film = read_cameras(tmp_path / "cameras.yaml")
    assert (front.name, front.source, front.parameters, front.frame) == ("front", "topic:/camera/image_raw", None, "")
    assert (left.source, left.parameters, left.frame) == ("2", tmp_path / "left.yml", "left_optical")
    assert (film.source, film.mount) == (str(tmp_path / "drive.mp4"), None)
    assert front.mount
    assert left.mount
    ahead = np.array([0.0, 0, 1])
    assert front.mount.apply(ahead) == pytest.approx([0.3, 0, -0.55])  # it looks down
    assert left.mount.apply(ahead) == pytest.approx([0, 1.25, 0.5])  # it looks to the left
    assert left.mount.apply(np.array([0.0, 1, 0])) == pytest.approx([0, 0.25, -0.5])  # y is down in the image


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (_CAMERAS, "x: 1", r"the file has an unknown key 'x'; known: cameras"),
        (_CAMERAS, "cameras: {}", r"no cameras found under the key 'cameras'"),
        ("source: 2", "sauce: 2", r":7:5: camera left has an unknown key 'sauce'; did you mean 'source'"),
        ("    source: 2\n", "", r":7:5: camera left has no source; add"),
        ("  left:", "  Left one:", r"the camera's name is 'Left one'; .* letters a-z"),
        ("left.yml", "7", r":8:17: camera left: parameters is 7; it must be a text"),
        ("rpy: [0, 0, 90]", "rpy: [0, 0]", r":10:44: camera left: mount: rpy is a list of 2; .* 3 numbers"),
        (", rpy: [0, 0, 90]", "", r":10:12: camera left: mount needs either rpy or orientation"),
    ],
)
def test_mistakes_in_the_file_of_cameras_are_told(tmp_path: Path, old: str, new: str, words: str) -> None:
    """With their place, and with the remedy."""
    assert old in _CAMERAS
    (tmp_path / "cameras.yaml").write_text(_CAMERAS.replace(old, new))
    with pytest.raises(SetupError, match=words):
        read_cameras(tmp_path / "cameras.yaml")


# --- ROS 2 --------------------------------------------------------------------------------------------------------


def _message(parent: str, child: str, pose: Pose, stamp: int = 0, turn: tuple[float, ...] = ()) -> bytes:
    quaternion = geometry_msgs.Quaternion(*(turn or quaternion_of(pose.rotation).tolist()))
    transform = geometry_msgs.Transform(geometry_msgs.Vector3(*pose.translation.tolist()), quaternion)
    header = Header(Time(stamp // _S, stamp % _S), parent)
    return cdr.encode(tf2_msgs.TFMessage([geometry_msgs.TransformStamped(header, child, transform)]))


def _topic(name: str) -> str:
    return name if name.startswith("/") else f"/{name}"


def test_transforms_of_ros_2_are_kept() -> None:
    """Static and moving ones make one tree; one that is none is told once and ignored."""
    graph, said = Graph(), list[str]()
    listener = TransformListener(MemoryMiddleware(graph), _topic, said.append)
    node = MemoryMiddleware(graph)
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


def test_the_rover_s_pose_and_the_transform_of_its_odometry_are_published() -> None:
    """Map to odom and odom to base are together the pose; without odometry there is no transform, and one message."""
    graph, said, poses, transforms = Graph(), list[str](), list[bytes](), list[bytes]()
    node, tree = MemoryMiddleware(graph), TransformTree()
    node.subscribe("/aruco/pose", geometry_msgs.PoseWithCovarianceStamped, Qos(), poses.extend)
    node.subscribe("/tf", tf2_msgs.TFMessage, Qos(), transforms.extend)
    publishing = RoverPublishing(MemoryMiddleware(graph), RoverFrames("base_link", "odom"), tree, _topic, said.append)
    pose = Pose(rotation_of(np.array([0, 0, 0.5])), np.array([4.0, 5, 0.1]))
    rover = RoverPose(7 * _S, FieldPose("map", pose, np.eye(6) * 0.01, (1, 2), ()))
    for _ in range(3):
        publishing.publish(rover)
    assert (len(poses), transforms) == (3, [])
    assert said == [
        "no transform from 'map' to 'odom' is published: no transforms connect 'odom' with 'base_link'; "
        "no transforms have come"
    ]
    message = cdr.decode(geometry_msgs.PoseWithCovarianceStamped, poses[0])
    assert (message.header.frame_id, message.header.stamp, message.pose.pose.position.x) == ("map", Time(7, 0), 4.0)
    odom = Pose(rotation_of(np.array([0, 0, -0.2])), np.array([1.0, -2, 0]))
    tree.add("odom", "base_link", 7 * _S, odom)
    publishing.publish(rover)
    ((sent,),) = (cdr.decode(tf2_msgs.TFMessage, data).transforms for data in transforms)
    assert (sent.header.frame_id, sent.child_frame_id, sent.header.stamp) == ("map", "odom", Time(7, 0))
    tree.add("map", "odom", 7 * _S, Pose(rotation_of(np.array([0, 0, 0.7])), _vector(sent.transform.translation)))
    assert tree.look_up("map", "base_link", 7 * _S).translation == pytest.approx(pose.translation)


def _vector(one: geometry_msgs.Vector3) -> np.ndarray:
    return np.array([one.x, one.y, one.z])
