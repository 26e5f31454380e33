"""Objects from the topics of a real rclpy camera driver to the basestation and back."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import pytest
from needs import NO_ONNX, NO_OPENCV
from programs import Start

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("onnxruntime", reason=NO_ONNX)

from judge import Judge  # skips this module where there is no rclpy

from rover.tests.objects_loop import run_the_loop


def test_the_whole_loop_with_a_real_node(judge: Judge, start: Start, middleware: str) -> None:
    """Images come from an rclpy node, which hears the positions; the programs use either middleware."""

    def hear(topic: str, type_name: str) -> Callable[[], Sequence[Mapping[str, Any]]]:
        heard = judge.hear(topic, type_name)
        return lambda: heard.values

    run_the_loop(start, middleware, judge.publishing, hear)
