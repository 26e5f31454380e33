"""``roverlink objects select``: the position of the object that the operator selects."""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Sequence
from contextlib import ExitStack
from types import SimpleNamespace
from typing import Any

import pytest
from needs import NO_OPENCV, needs_dds
from node_in_memory import NodeInMemory, hear
from polling import wait_until
from programs import Start
from repeating import repeated

from generated.messages import BasestationObjectSelection
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import geometry_msgs, std_msgs, tf2_msgs, vision_msgs
from roverlink.runtime.middleware import Middleware, NodeIdentity, open_middleware

cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
np = pytest.importorskip("numpy", reason=NO_OPENCV)

from roverkit.objects.detected_objects import Box, TrackedObject  # noqa: E402
from roverkit.objects.location import Location  # noqa: E402
from roverkit.objects.selecting import Selector  # noqa: E402
from roverkit.vision import Pose  # noqa: E402
from roverkit.vision.poses.pose import rotation_of  # noqa: E402
from roverkit.vision.ros.landmark_messages import transform_of  # noqa: E402
from roverkit.vision.ros.object_messages import detections_3d_of  # noqa: E402

_OPTICAL = "camera_optical"
_MOUNT = Pose(
    rotation_of(np.array([0, 0.1, 0])) @ np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]]), np.array([0.3, 0, 0.5])
)
_ROVER = Pose(rotation_of(np.array([0, 0, 1.0])), np.array([7.0, 2, 0]))
"""Rover on the field."""
_TOPICS: dict[str, type[Message]] = {
    "/selected_object/pose": geometry_msgs.PoseStamped,
    "/selected_object/pose_with_covariance": geometry_msgs.PoseWithCovarianceStamped,
    "/selected_object/map/pose": geometry_msgs.PoseStamped,
    "/selected_object/map/pose_with_covariance": geometry_msgs.PoseWithCovarianceStamped,
    "/selected_object/state": std_msgs.String,
}


class _Listener:
    """A behaviour node."""

    def __init__(self, node: Middleware) -> None:
        latched = Qos(depth=1, durability="transient_local")
        self.heard: dict[str, list[Any]] = {
            topic: hear(node, topic, kind, latched if kind is std_msgs.String else None)
            for topic, kind in _TOPICS.items()
        }

    @property
    def states(self) -> list[str]:
        """States that have been reported."""
        return [one.data for one in self.heard["/selected_object/state"]]

    def newest(self, topic: str) -> Any:
        """The newest message of a topic below selected_object; None if there is none."""
        return next(iter(self.heard[f"/selected_object/{topic}"][::-1]), None)


class _Rover:
    """The tracker and the transforms of a rover."""

    def __init__(self, node: Middleware) -> None:
        self._objects = node.publisher("/objects/detections_3d", vision_msgs.Detection3DArray, Qos())
        self._tf = node.publisher("/tf", tf2_msgs.TFMessage, Qos(depth=100))

    def see(self, **objects: Sequence[float]) -> None:
        """The camera sees objects, such as _3=(0, 0, 2), in its optical frame."""
        stamp = time.time_ns()
        mount, place = (_MOUNT, "base_link", _OPTICAL), (_ROVER, "map", "base_link")
        transforms = [transform_of(*one, stamp) for one in (mount, place)]
        self._tf.publish([cdr.encode(tf2_msgs.TFMessage(transforms))])
        places = {int(name[1:]): Location(np.array(point, float), np.eye(3) / 100) for name, point in objects.items()}
        tracked = [TrackedObject(number, Box(0, 0, 1, 1), "rock", 0.9) for number in places]
        self._objects.publish([cdr.encode(detections_3d_of(tracked, places, stamp, _OPTICAL))])


def _point(message: Any) -> list[float]:
    position = (message.pose.pose if hasattr(message.pose, "pose") else message.pose).position
    return [position.x, position.y, position.z]


@pytest.mark.slow
@needs_dds
def test_a_selected_object_is_located_held_and_lost(start: Start) -> None:
    """In the frames of the rover and of the field; a behaviour node that comes later learns the state."""
    point = np.array([0.2, -0.1, 2.0])
    with ExitStack() as held:
        node = held.enter_context(open_middleware("dds", NodeIdentity("rover")))
        rover, listener = _Rover(node), _Listener(node)
        program = start("objects", "select", "--middleware", "dds", "--hold", "1", "--json")
        program.wait_for("waiting for selections on /object_selection")
        selections = node.publisher("/object_selection", BasestationObjectSelection, Qos())
        with repeated(lambda _: rover.see(_7=point)):

            def located() -> Any:
                selections.publish([cdr.encode(BasestationObjectSelection(7))])
                return listener.newest("map/pose_with_covariance")

            message = wait_until(located, "the position")
        assert message.header.frame_id == "map"
        assert _point(message) == pytest.approx(_ROVER.apply(_MOUNT.apply(point)).tolist(), abs=1e-6)
        assert _point(listener.newest("pose")) == pytest.approx(_MOUNT.apply(point).tolist(), abs=1e-6)
        wait_until(lambda: "lost 7" in listener.states, "the loss")
        late = _Listener(node)
        wait_until(lambda: late.states == ["lost 7"], "the state")
        assert program.interrupt() == 0
    told = [json.loads(line) for line in program.output]
    assert [one for one in told if one["state"] != "refused"][-3:] == [
        {"state": "visible", "id": 7},
        {"state": "held", "id": 7},
        {"state": "lost", "id": 7},
    ]


class _Selecting(NodeInMemory):
    """The program in memory, without its command line and its loop; its time stands still."""

    def __init__(self, held: ExitStack) -> None:
        super().__init__(held, "object_selection")
        self.time = time.time_ns()
        self.connection.clock = SimpleNamespace(now=lambda: self.time)  # type: ignore[assignment]  # a clock of the test
        options = argparse.Namespace(base_frame="base_link", map_frame="map", hold=2.0, json=False)
        self.selector = Selector(self.connection, options, self.logger)
        self.listener = _Listener(self.middleware)
        self.see = _Rover(self.middleware).see
        self.middleware.subscribe("/objects/detections_3d", vision_msgs.Detection3DArray, Qos(), self._see)

    def _see(self, messages: Sequence[bytes]) -> None:
        for data in messages:
            self.selector.see(cdr.decode(vision_msgs.Detection3DArray, data))
            self.selector.hold()

    def select(self, number: int) -> None:
        """The operator selects an object."""
        self.selector.select(number)
        self.selector.hold()

    def wait(self, seconds: float) -> None:
        """Time passes."""
        for _ in range(round(seconds * 10)):
            self.time += 100_000_000
            self.selector.hold()


@pytest.fixture
def selecting() -> Any:
    with ExitStack() as held:
        yield _Selecting(held)


def test_a_hidden_object_is_held_with_a_growing_covariance(selecting: _Selecting) -> None:
    """Its place is published ten times a second until it is lost, which is reported once."""
    selecting.see(_3=(0, 0, 2))
    selecting.select(3)
    first = selecting.listener.newest("pose_with_covariance").pose.covariance[0]
    selecting.wait(1)
    grown = selecting.listener.newest("pose_with_covariance").pose.covariance[0]
    assert grown - first == pytest.approx(0.1**2, rel=0.01)
    selecting.wait(5)
    count = len(selecting.listener.heard["/selected_object/pose"])
    assert 15 <= count <= 25
    selecting.see(_3=(0, 0, 2))
    selecting.wait(1)
    assert len(selecting.listener.heard["/selected_object/pose"]) == count
    assert selecting.listener.states == ["visible 3", "held 3", "lost 3"]


def test_an_object_is_held_while_the_camera_sees_others(selecting: _Selecting) -> None:
    """Messages about other objects do not delay it."""
    selecting.see(_3=(0, 0, 2), _4=(1, 0, 2))
    selecting.select(3)
    for _ in range(20):
        selecting.time += 50_000_000
        selecting.see(_4=(1, 0, 2))
    assert selecting.listener.states == ["visible 3", "held 3"]
    assert len(selecting.listener.heard["/selected_object/pose"]) > 5


def test_a_selection_of_an_unknown_object_is_refused_and_reported(selecting: _Selecting) -> None:
    """The message names the visible objects, and the earlier selection remains; number 0 ends it."""
    selecting.see(_3=(0, 0, 2), _5=(0, 1, 2))
    selecting.select(3)
    selecting.select(9)
    assert selecting.listener.states == ["visible 3", "refused 9", "visible 3"]
    assert "object 9 is not selected, because no camera sees it (visible: 3, 5)" in selecting.log
    count = len(selecting.listener.heard["/selected_object/pose"])
    selecting.select(0)
    selecting.see(_3=(0, 0, 2))
    assert selecting.listener.states[-1] == "none"
    assert len(selecting.listener.heard["/selected_object/pose"]) == count
