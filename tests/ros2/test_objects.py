"""Objects from the topics of a real rclpy camera driver to the basestation and back."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import pytest
from needs import NO_ONNX, NO_OPENCV
from programs import Start
from repeating import repeated

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("onnxruntime", reason=NO_ONNX)

from judge import Judge, interface  # skips this module where there is no rclpy
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message

from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Message
from tests.objects_loop import run_the_loop


def test_the_whole_loop_with_a_real_node(judge: Judge, start: Start, middleware: str) -> None:
    """Images come from an rclpy node, which hears the positions; the programs use either middleware."""

    def hear(topic: str, type_name: str) -> Callable[[], Sequence[Mapping[str, Any]]]:
        heard = judge.hear(topic, type_name)
        return lambda: heard.values

    @contextmanager
    def publish(topics: Mapping[str, type[Message]], make: Callable[[int], Iterable[Message]]) -> Iterator[None]:
        publishers = [
            judge.node.create_publisher(interface(kind.__msgtype__), topic, QoSProfile(depth=5))
            for topic, kind in topics.items()
        ]

        def once(number: int) -> None:
            for publisher, message in zip(publishers, make(number), strict=True):
                publisher.publish(deserialize_message(cdr.encode(message), publisher.msg_type))

        with repeated(once, 0.05):
            yield

    run_the_loop(start, middleware, publish, hear)
