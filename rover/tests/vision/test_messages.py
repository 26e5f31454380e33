"""What is seen as ROS 2 messages, read by somebody else's code."""

from __future__ import annotations

import importlib
import math
import pkgutil
from functools import cache
from typing import Any

import numpy as np
import pytest
from roverkit.vision import CameraParameters, FieldPose, LandmarkDetection, Pose
from roverkit.vision.poses.pose import quaternion_of, rotation_of
from roverkit.vision.ros import landmark_messages
from roverkit.vision.ros.landmark_messages import FrameNames

from rover.tests.vision.seen import FACING, detection
from roverlink.generator.emit.targets.python.runtime_interfaces import store
from roverlink.runtime import interfaces
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Array, Message, Primitive, Sequence, Text, fields_of

_STAMP = 1_700_000_000_123_456_789
_NAMES = FrameNames("eye", "mark_")
_HYPOTHESIS = "RIHS01_51da43cec11c01957a64d1e05a24acd18aae7745ec30b74348ad5f6d634f7f90"
"""The hash of ObjectHypothesis in code that ROS 2 generated."""
_store = cache(store)  # not at the import, since it takes a fifth of a second


def _ours_of(package: str) -> list[type[Message]]:
    """The messages of a package; rosbags knows no services, which tests/ros2 compares with rosidl's."""
    module = importlib.import_module(f"roverlink.runtime.interfaces.{package}")
    classes = [one for one in vars(module).values() if isinstance(one, type) and issubclass(one, Message)]
    return [one for one in classes if one.__module__ == module.__name__ and "/srv/" not in one.__msgtype__]


OURS = [one for package in pkgutil.iter_modules(interfaces.__path__) for one in _ours_of(package.name)]


def _read(message: Message) -> Any:
    return _store().deserialize_cdr(cdr.encode(message), message.__msgtype__)


def _seen(rotation: Any = FACING, number: int = 7) -> LandmarkDetection:
    one = detection(number, Pose(rotation, np.array([0.1, -0.2, 1.5])), np.random.default_rng(1))
    return LandmarkDetection(
        **{name: getattr(one, name) for name in LandmarkDetection.__slots__ if name != "stamp"}, stamp=_STAMP
    )


def _ours(kind: Any) -> Any:
    if isinstance(kind, Primitive):
        return kind.name
    if isinstance(kind, Sequence | Array):
        return (_ours(kind.element), kind.length if isinstance(kind, Array) else kind.bound or 0)
    return "string" if isinstance(kind, Text) else kind.__msgtype__


def _theirs(definition: Any) -> Any:
    kind, detail = definition
    if kind.name in ("SEQUENCE", "ARRAY"):
        return (_theirs(detail[0]), detail[1])
    return detail if kind.name == "NAME" else detail[0]


@pytest.mark.parametrize("ours", OURS, ids=lambda one: one.__name__)
def test_the_definitions_are_those_of_ros_2(ours: type[Message]) -> None:
    """Names, types and order of the fields are those of the packages, and so is the hash where we say one."""
    name = ours.__msgtype__
    expected = [(field, _theirs(definition)) for field, definition in _store().fielddefs[name][1]]
    assert [(field.name, _ours(field.type)) for field in fields_of(ours)] == expected
    assert ours.__typehash__ in ("", _store().hash_rihs01(name))
    assert _store().hash_rihs01("vision_msgs/msg/ObjectHypothesis") == _HYPOTHESIS  # by our text of the package


def test_a_transform_takes_the_markers_points_to_the_camera() -> None:
    """Frames and stamp are said; the quaternion, as tf2 applies it, is the rotation."""
    rotation = rotation_of(np.array([0.3, -0.8, 0.2])) @ FACING
    one = _seen(rotation)
    (transform,) = _read(landmark_messages.transforms_of([one], _NAMES)).transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("eye", "mark_7")
    assert transform.header.stamp.sec * 10**9 + transform.header.stamp.nanosec == _STAMP
    t, q = transform.transform.translation, transform.transform.rotation
    assert [t.x, t.y, t.z] == one.pose.translation.tolist()
    v = np.array([q.x, q.y, q.z])
    for point in np.eye(3):
        turned = point + 2 * q.w * np.cross(v, point) + 2 * np.cross(v, np.cross(v, point))
        assert turned == pytest.approx(one.pose.rotation @ point, abs=1e-12)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.7, 3.0, math.pi])
@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 0.6, -0.8), (2 / 3, -2 / 3, 1 / 3)])
def test_quaternions_of_all_turns(angle: float, axis: tuple[float, float, float]) -> None:
    """From no turn to half a turn about any axis, the quaternion has length 1 and is the turn."""
    found = quaternion_of(rotation_of(angle * np.array(axis)))
    expected = np.append(np.sin(angle / 2) * np.array(axis), np.cos(angle / 2))
    assert min(np.abs(found - expected).max(), np.abs(found + expected).max()) < 1e-7
    assert found[3] >= 0


def test_a_pose_has_its_covariance_row_by_row() -> None:
    """In the order x y z rotX rotY rotZ of ROS 2; that of the camera is in the frame of the field."""
    one = _seen()
    message = _read(landmark_messages.marker_pose_of(one, _NAMES))
    assert message.header.frame_id == "eye"
    assert np.reshape(message.pose.covariance, (6, 6)).tolist() == one.covariance.tolist()
    place = FieldPose("mars_yard", Pose(np.eye(3), np.array([1.0, 2.0, 3.0])), np.diag(np.arange(6.0)), (7,), ())
    message = _read(landmark_messages.field_pose_of(place, _STAMP))
    position = message.pose.pose.position
    assert (message.header.frame_id, message.header.stamp.nanosec) == ("mars_yard", 123_456_789)
    assert [position.x, position.y, position.z, message.pose.covariance[7 * 5]] == [1, 2, 3, 5]


def test_a_detection_has_both_poses_and_a_box() -> None:
    """The pose that was decided for comes first; scores are what the frame alone says, and sum to 1."""
    one = _seen(rotation_of(np.array([0.5, 0, 0])) @ FACING)
    message = _read(landmark_messages.detections_of([one], _STAMP, _NAMES))
    (detection,) = message.detections
    chosen, other = detection.results
    assert (detection.id, chosen.hypothesis.class_id) == ("mark_7", "7")
    assert chosen.pose.pose.position.z == one.pose.translation[2]
    assert other.pose.pose.orientation.x != chosen.pose.pose.orientation.x
    assert chosen.hypothesis.score > 0.99
    assert chosen.hypothesis.score + other.hypothesis.score == pytest.approx(1)
    size = detection.bbox.size
    assert [size.x, size.y, size.z] == pytest.approx([0.15, 0.15, 0])
    assert detection.bbox.center.position.z == pytest.approx(one.pose.translation[2])


def test_the_camera_info_is_of_images_that_nobody_rectified() -> None:
    """K, D, R and P as REP-104 and image_pipeline read them."""
    distortion, model = (0.1, 0.2, 0.3, 0.4), "equidistant"
    matrix = np.array([[900.0, 0, 640], [0, 910, 360], [0, 0, 1]])
    camera = CameraParameters(matrix, np.array(distortion), (1280, 720), fisheye=True)
    info = _read(landmark_messages.camera_info_of(camera, (1280, 720), _STAMP, _NAMES))
    assert (info.width, info.height, info.distortion_model, info.header.frame_id) == (1280, 720, model, "eye")
    assert info.d.tolist() == list(distortion)
    assert info.k.tolist() == matrix.ravel().tolist()
    assert info.r.tolist() == np.eye(3).ravel().tolist()
    assert info.p.tolist() == [900, 0, 640, 0, 0, 910, 360, 0, 0, 0, 1, 0]
