"""``roverlink rocks measure``: requests of the basestation, depth images over ROS 2, and the answers."""

from __future__ import annotations

import argparse
import math
import threading
from contextlib import AbstractContextManager, ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from linked import TABLE, write_project
from needs import NO_OPENCV
from node_in_memory import NodeInMemory
from polling import wait_until

from generated.messages import BasestationRockMeasureRequest, BasestationRockMeasureResult
from generated.registry import REGISTRY
from roverlink.runtime import load_registry
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware import Middleware

cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
np = pytest.importorskip("numpy", reason=NO_OPENCV)

from roverkit.rocks.camera_parameters import CameraTopicParameters  # noqa: E402
from roverkit.rocks.ground import Ground  # noqa: E402
from roverkit.rocks.measurement import RockSize  # noqa: E402
from roverkit.rocks.measuring import Answering  # noqa: E402
from roverkit.rocks.rock_rows import RockRows  # noqa: E402
from roverkit.rocks.unmeasurable import Unmeasurable  # noqa: E402
from roverkit.vision.frames import depth_camera  # noqa: E402
from roverkit.vision.frames.depth_camera import DepthCamera  # noqa: E402

from rover.bench.vision.rock_scenes import RockScene, camera, scenes  # noqa: E402  # they need OpenCV
from rover.tests.vision.d435i import BEGAN_NS, COLOUR, PERIOD_NS  # noqa: E402
from rover.tests.vision.ros_images import camera_info, image, publishing  # noqa: E402
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo, Image  # noqa: E402


@pytest.fixture(scope="module")
def scene() -> RockScene:
    """A rock before the depth camera."""
    return next(scenes(1, 4))


def _driver(
    node: Middleware, scene: RockScene, namespace: str = "/camera/camera", **fields: Any
) -> AbstractContextManager[None]:
    """A driver that publishes the depth of a scene in millimetres, and the parameters of the colour camera."""
    millimetres = np.rint(1000 * np.nan_to_num(scene.depth)).astype(np.uint16)

    def messages(number: int) -> tuple[Image, CameraInfo]:
        stamp = BEGAN_NS + PERIOD_NS * number
        return image(millimetres, "16UC1", stamp), replace(camera_info(camera(), stamp), **fields)

    topics = {f"{namespace}/aligned_depth_to_color/image_raw": Image, f"{namespace}/color/camera_info": CameraInfo}
    return publishing(node, topics, messages)


def _is_size(scene: RockScene, result: BasestationRockMeasureResult) -> bool:
    return (
        result.failure == BasestationRockMeasureResult.ROCK_MEASURE_FAILURE_NONE
        and result.length_cm == pytest.approx(100 * scene.length, abs=2.5 * result.length_sigma_cm)
        and result.width_cm == pytest.approx(100 * scene.width, abs=2.5 * result.width_sigma_cm)
        and result.length_sigma_cm < 0.05 * result.length_cm
    )


class _Measuring(NodeInMemory):
    """The program without its command line."""

    def __init__(self, held: ExitStack, *, depth: str | None = None, camera_info: str | None = None) -> None:
        words = argparse.Namespace(camera=COLOUR, depth=depth, camera_info=camera_info)
        super().__init__(held, "rock_measurement", (), lambda *given: CameraTopicParameters(words, *given))
        self._camera = DepthCamera(self.connection, lambda: self.parameters.meaning, self.logger.warning)
        self._answers: list[bytes] = []
        self._answering = Answering(self._camera, RockRows(REGISTRY), self._answers.extend, self.logger, as_json=False)
        threading.Thread(target=self._camera.receive, daemon=True).start()

    def answer(self, scene: RockScene) -> BasestationRockMeasureResult:
        """The answer to a request with the line of a scene."""
        self._answering.take([cdr.encode(BasestationRockMeasureRequest(*scene.line))])
        return cdr.decode(BasestationRockMeasureResult, self._answers.pop())

    def reason(self, scene: RockScene, what: str) -> str:
        """Wait until the answer is no size, for a reason with a text."""

        def reason() -> str:
            assert math.isnan(self.answer(scene).length_cm)
            return self.log[-1] if what in self.log[-1] else ""

        return wait_until(reason, what)

    def ignores(self, data: bytes) -> bool:
        """True if there is no answer to a message."""
        self._answering.take([data])
        return not self._answers


@pytest.mark.slow
def test_ros_2_selects_the_camera(scene: RockScene, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another camera has its own depth, the old one is not used any more, and one that has stopped is not measured."""
    with ExitStack() as held:
        measuring = _Measuring(held)
        held.enter_context(_driver(measuring.middleware, scene))
        wait_until(lambda: _is_size(scene, measuring.answer(scene)), "a size")
        measuring.parameters.change({"camera": "/right/color/image_raw"})
        assert math.isnan(measuring.answer(scene).length_cm)
        assert "no depth came on /right/aligned_depth_to_color/image_raw" in measuring.log[-1]
        with _driver(measuring.middleware, scene, "/right"):
            wait_until(lambda: _is_size(scene, measuring.answer(scene)), "a size")
        monkeypatch.setattr(depth_camera, "STALLED_S", 0.0)
        answer = measuring.answer(scene)
        assert all(map(math.isnan, (answer.length_cm, answer.length_sigma_cm, answer.width_sigma_cm)))
        assert answer.failure == BasestationRockMeasureResult.ROCK_MEASURE_FAILURE_NO_IMAGE
        assert "no size of the rock (no_image)" in measuring.log[-1]


@pytest.mark.slow
def test_a_camera_that_is_not_calibrated_gives_no_size(scene: RockScene) -> None:
    """The reason names the topic and the cure."""
    with ExitStack() as held:
        measuring = _Measuring(held)
        held.enter_context(_driver(measuring.middleware, scene, k=[0.0] * 9))
        assert measuring.reason(scene, "/camera/camera/color/camera_info: the camera is not calibrated")


def test_the_topics_may_be_named(scene: RockScene) -> None:
    """Colour images as depth are no depth, and the reason says so."""
    with ExitStack() as held:
        measuring = _Measuring(held, depth="/grey", camera_info="/info")
        grey, info = image(np.zeros((480, 640), np.uint8), "mono8"), camera_info(camera())
        held.enter_context(
            publishing(measuring.middleware, {"/grey": Image, "/info": CameraInfo}, lambda _: (grey, info))
        )
        assert measuring.reason(scene, "an image with the encoding mono8 shows no depths")


def test_a_damaged_request_is_told() -> None:
    """There is nothing to answer."""
    with ExitStack() as held:
        measuring = _Measuring(held)
        assert measuring.ignores(b"\0\1\0\0\1")
        assert measuring.log[-1].startswith("ignoring a request that cannot be read: ")


def test_an_answer_repeats_the_number_of_its_request(tmp_path: Path) -> None:
    """If the table makes the row a request with a correlation field, the result has the request's number."""
    rows = """
      - {number: 1, name: rock_measure_request, proto: rocky.Ask, topic: a, direction: base_to_ros,
         request: {response: rock_measure_result, field: id}}
      - {number: 2, name: rock_measure_result, proto: rocky.Told, topic: b, direction: ros_to_base}
    """
    table = TABLE[: TABLE.index("link: ")].replace("linked", "rocky") + f"messages:{rows}"
    proto = """syntax = "proto3"; package rocky;
    message Ask { uint32 x1 = 1; uint32 y1 = 2; uint32 x2 = 3; uint32 y2 = 4; uint32 id = 5; }
    message Told { float length_cm = 1; float width_cm = 2; uint32 id = 3; }"""
    registry = load_registry(write_project(tmp_path / "project", table, proto, "rocky"), "rocky_rover")
    rocks, asked, told = RockRows(registry), *registry.handlers
    request = asked.to_cdr(asked.payload_type(x2=9, id=7))
    assert rocks.line(request) == (0, 0, 9, 0)
    size = RockSize(0.5, 0.01, 0.25, 0.02, Ground(np.array([0, -1.0, 0]), 1.0, 1.0), 1.0)
    result = told.from_cdr(rocks.answer(size, request))
    assert (result.length_cm, result.width_cm, result.id) == (50, 25, 7)
    assert math.isnan(told.from_cdr(rocks.answer(Unmeasurable.NO_ROCK, request)).length_cm)
