"""Camera and receivers for the section `receiving`. A receiver answers each line on stdin with its number of images.

python -m rover.bench.vision.image_tools camera dds|rclpy ENCODING
python -m rover.bench.vision.image_tools source dds|rclpy
python -m rover.bench.vision.image_tools rclpy
"""

from __future__ import annotations

import json
import sys
import threading
import time
from collections.abc import Callable

import numpy as np

TOPIC = "/camera/color/image_raw"
SIZE = (640, 480)
RATE_HZ = 30


def camera(middleware_name: str, encoding: str) -> None:
    """Publish images as a camera driver does, until stdin ends."""
    from roverlink.runtime import Qos
    from roverlink.runtime.core import cdr
    from roverlink.runtime.interfaces import Time
    from roverlink.runtime.interfaces.sensor_msgs import Image
    from roverlink.runtime.interfaces.std_msgs import Header
    from roverlink.runtime.middleware import NodeIdentity, open_middleware

    width, height = SIZE
    pixels = np.random.default_rng(1).integers(0, 256, (height, width, 3), np.uint8).tobytes()
    ended = threading.Event()
    threading.Thread(target=_set_at_end, args=(ended,), daemon=True).start()
    with open_middleware(middleware_name, NodeIdentity("camera")) as middleware:
        publisher = middleware.publisher(TOPIC, Image, Qos(depth=5))
        due = time.monotonic()
        while not ended.wait(max(due - time.monotonic(), 0)):
            header = Header(Time.since_1970(time.time_ns()), "camera")
            publisher.publish([cdr.encode(Image(header, height, width, encoding, 0, 3 * width, pixels))])
            due += 1 / RATE_HZ


def source(middleware_name: str) -> None:
    """Take frames from a topic, as the camera programs do."""
    from roverkit.vision.frames import TopicSource

    from roverlink.runtime.middleware import NodeIdentity, open_middleware

    taken = 0
    with (
        open_middleware(middleware_name, NodeIdentity("receiver")) as middleware,
        TopicSource(middleware, TOPIC, lambda text: print(text, file=sys.stderr)) as frames,
    ):

        def take() -> None:
            nonlocal taken
            for _ in frames:
                taken += 1

        threading.Thread(target=take, daemon=True).start()
        _answer(lambda: taken)


def plain() -> None:
    """Receive images with rclpy as its tutorials do, and make an array of each."""
    import rclpy
    from sensor_msgs.msg import Image

    taken = 0

    def take(message: Image) -> None:
        nonlocal taken
        np.frombuffer(message.data, np.uint8).reshape(message.height, message.width, 3)
        taken += 1

    rclpy.init()
    node = rclpy.create_node("receiver")
    node.create_subscription(Image, TOPIC, take, 5)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    _answer(lambda: taken)


def _set_at_end(ended: threading.Event) -> None:
    sys.stdin.read()
    ended.set()


def _answer(taken: Callable[[], int]) -> None:
    for _ in sys.stdin:
        print(json.dumps({"frames": taken()}), flush=True)


def main(words: list[str]) -> None:
    """Be the camera or a receiver, until stdin ends."""
    match words:
        case ["camera", middleware_name, encoding]:
            camera(middleware_name, encoding)
        case ["source", middleware_name]:
            source(middleware_name)
        case _:
            plain()


if __name__ == "__main__":
    main(sys.argv[1:])
