"""Objects from a depth camera to the basestation and back, over DDS and UDP."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from typing import Any

import pytest
from needs import NO_ONNX, NO_OPENCV, needs_dds
from programs import Start
from repeating import repeated

from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import geometry_msgs
from roverlink.runtime.middleware import NodeIdentity, open_middleware
from roverlink.runtime.text.values import message_to_values

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("onnxruntime", reason=NO_ONNX)

from rover.tests.objects_loop import run_the_loop  # it needs OpenCV


@needs_dds
@pytest.mark.slow
def test_the_whole_loop_over_dds(start: Start) -> None:
    """Detections, selection, position and size are those of the rendered scenes."""
    with ExitStack() as held:
        node = held.enter_context(open_middleware("dds", NodeIdentity("camera")))

        def hear(topic: str, type_name: str) -> Callable[[], Sequence[Mapping[str, Any]]]:
            kind = getattr(geometry_msgs, type_name.rpartition("/")[2])
            heard: list[bytes] = []
            node.subscribe(topic, kind, Qos(), heard.extend)
            return lambda: [message_to_values(cdr.decode(kind, data)) for data in heard]

        @contextmanager
        def publish(topics: Mapping[str, type[Message]], make: Callable[[int], Iterable[Message]]) -> Iterator[None]:
            publishers = [node.publisher(topic, kind, Qos(depth=5)) for topic, kind in topics.items()]

            def once(number: int) -> None:
                for publisher, message in zip(publishers, make(number), strict=True):
                    publisher.publish([cdr.encode(message)])

            with repeated(once, 0.05):
                yield

        run_the_loop(start, "dds", publish, hear)
