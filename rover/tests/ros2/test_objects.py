"""Objects from the topics of a real rclpy depth camera to the basestation, and back by its selections and requests.

The camera, and whoever hears the poses, are nodes of the test; the rest are the programs.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from typing import Any

import pytest
from needs import NO_ONNX, NO_OPENCV
from polling import wait_until
from programs import Start

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("onnxruntime", reason=NO_ONNX)

import cv2
import numpy as np
from judge import Judge  # skips this module where there is no rclpy
from numpy.typing import NDArray
from roverkit.objects.detected_objects import Box
from roverkit.objects.metrics import overlap
from roverkit.objects.scenes import CAMERA, RenderedScene, SceneObject, sequence
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.poses.pose import Pose, rotation_of
from roverkit.vision.ros.landmark_messages import transform_of

from generated.pb2.components.basestation.detected_object_pb2 import BasestationDetectedObject, DetectedObjectType
from generated.pb2.components.basestation.object_selection_pb2 import BasestationObjectSelection
from generated.pb2.components.basestation.rock_measure_request_pb2 import BasestationRockMeasureRequest
from generated.pb2.components.basestation.rock_measure_result_pb2 import BasestationRockMeasureResult
from generated.registry import REGISTRY
from rover.bench.vision.rock_scenes import RockScene
from rover.bench.vision.rock_scenes import camera as rock_camera
from rover.bench.vision.rock_scenes import scenes as rock_scenes
from rover.tests.vision.d435i import COLOUR, DEPTH, INFO
from rover.tests.vision.ros_images import FRAME, camera_info, image
from roverlink.runtime.client import BlockingPeer, Reassembler
from roverlink.runtime.interfaces import tf2_msgs
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo, Image

_OPTICAL = np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])
_MOUNT = Pose(rotation_of(np.radians([0, 5.0, 8.0])) @ _OPTICAL, np.array([0.31, -0.04, 0.42]))
"""From the optical frame to base_link."""


class _DepthCamera:
    """A depth camera on a rover that stands before a panel, and later before a rock."""

    def __init__(self) -> None:
        self.scene: RenderedScene = next(sequence(4, 1, panel=True))
        self.rock: RockScene = next(rock_scenes(1, 4))
        self.shows_rock = False
        rng = np.random.default_rng(0)
        self._depths = [_measured(self.scene.depth, rng) for _ in range(4)]
        self._rock = np.rint(1000 * np.nan_to_num(self.rock.depth)).astype(np.uint16)

    def messages(self, number: int) -> tuple[Image, Image, CameraInfo, tf2_msgs.TFMessage]:
        """Colour, depth, the camera's parameters, and the place of the rover on the field, with one stamp."""
        stamp = time.time_ns()
        colour = image(np.ascontiguousarray(self.scene.image[:, :, ::-1]), "rgb8", stamp)
        depth = image(self._rock if self.shows_rock else self._depths[number % len(self._depths)], "16UC1", stamp)
        info = camera_info(rock_camera() if self.shows_rock else CAMERA, stamp)
        on_field = transform_of(self.scene.camera @ _MOUNT.inverse(), "map", "base_link", stamp)
        return colour, depth, info, tf2_msgs.TFMessage([on_field, transform_of(_MOUNT, "base_link", FRAME, stamp)])


def _measured(depth: Floats, rng: np.random.Generator) -> NDArray[np.uint16]:
    """A depth image as a stereo camera publishes it: in millimetres, with noise of 1 % and holes (0)."""
    noisy = depth * (1 + rng.normal(0, 0.01, depth.shape))
    noisy[cv2.resize(rng.random((60, 80)), depth.shape[::-1]) > 0.93] = np.nan
    return np.nan_to_num(np.rint(1000 * noisy)).astype(np.uint16)


def test_the_whole_loop_with_a_real_node(judge: Judge, start: Start, middleware: str) -> None:
    """Images come from an rclpy node, which hears the positions; all results are those of the rendered scenes."""
    camera = _DepthCamera()
    topics = {COLOUR: Image, DEPTH: Image, INFO: CameraInfo, "/tf": tf2_msgs.TFMessage}
    with ExitStack() as held:
        client = held.enter_context(
            BlockingPeer.open("basestation", registry=REGISTRY, local_address="127.0.0.1", local_port=0)
        )
        given = ("listen_port:=0", "listen_address:='127.0.0.1'", f"dst_a_port:={client.port}")
        words = [word for one in given for word in ("-p", one)]
        bridge = start("run", "--middleware", middleware, "--ros-args", *words)
        client.direct_to("127.0.0.1", int(bridge.wait_for("on UDP port ").rpartition(" ")[2]))
        on_field = judge.hear("/selected_object/map/pose", "geometry_msgs/msg/PoseStamped")
        on_rover = judge.hear("/selected_object/pose_with_covariance", "geometry_msgs/msg/PoseWithCovarianceStamped")
        start("objects", "select", "--middleware", middleware).wait_for("waiting for selections")
        start("rocks", "measure", COLOUR, "--middleware", middleware).wait_for("requests on")
        held.enter_context(judge.publishing(topics, camera.messages))
        start("objects", "track", f"topic:{COLOUR}", "--middleware", middleware)

        truth, number = _seen_object(client, camera.scene.objects)

        def located() -> bool:
            client.send(BasestationObjectSelection(object_id=number))
            return len(on_field.values) > 2 and len(on_rover.values) > 2

        wait_until(located, f"the position of object {number}")
        expected = camera.scene.camera.apply(truth.position)
        assert _place(on_field.values[-1]["pose"]) == pytest.approx(expected.tolist(), abs=0.05)
        pose = on_rover.values[-1]["pose"]
        error = np.array(_place(pose["pose"])) - _MOUNT.apply(truth.position)
        covariance = np.reshape(pose["covariance"], (6, 6))[:3, :3]
        assert error @ np.linalg.solve(covariance, error) < 16.3  # 99.9 % of chi squared with 3 degrees of freedom

        camera.shows_rock = True
        x1, y1, x2, y2 = camera.rock.line

        def sizes() -> list[BasestationRockMeasureResult]:
            client.send(BasestationRockMeasureRequest(x1=x1, y1=y1, x2=x2, y2=y2))
            found = [payload for _, payload in client.arrived() if isinstance(payload, BasestationRockMeasureResult)]
            return [one for one in found if one.length_cm == pytest.approx(100 * camera.rock.length, rel=0.04)]

        result = wait_until(sizes, "the size of the rock")[-1]
        assert result.width_cm == pytest.approx(100 * camera.rock.width, rel=0.08)


def _seen_object(client: BlockingPeer, truth: Sequence[SceneObject]) -> tuple[SceneObject, int]:
    """Wait for a frame in which most objects are found with their types; return the surest one, and its number."""
    reassembler = Reassembler[Any]()

    def matched() -> list[tuple[float, SceneObject, int]]:
        for _, payload in client.arrived():
            frame = reassembler.add(payload) if isinstance(payload, BasestationDetectedObject) else None
            pairs = itertools.product(frame.parts if frame else (), truth)
            found = [(part.confidence, one, part.id) for part, one in pairs if _is(part, one)]
            if len({one.number for _, one, _ in found}) >= 0.7 * len(truth):
                return found
        return []

    _, best, number = max(wait_until(matched, "a frame with the objects"), key=lambda one: one[0])
    return best, number


def _is(part: Any, one: SceneObject) -> bool:
    box = Box(part.bbox.x, part.bbox.y, part.bbox.width, part.bbox.height)
    return DetectedObjectType.Name(part.type) == f"OBJECT_{one.class_name.upper()}" and overlap(box, one.box) >= 0.5


def _place(pose: Mapping[str, Any]) -> list[float]:
    return [pose["position"][axis] for axis in "xyz"]
