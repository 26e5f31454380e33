"""Images and camera parameters as ROS 2 messages, and publishers of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray
from repeating import repeated
from roverkit.vision.camera.camera_model import CameraParameters
from roverkit.vision.camera.parameters_file import model_name

from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces import Time
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo, CompressedImage, Image
from roverlink.runtime.interfaces.std_msgs import Header
from roverlink.runtime.middleware import Middleware

FRAME = "camera_color_optical_frame"


def header(stamp: int, frame_id: str = FRAME) -> Header:
    """A header with a stamp in nanoseconds."""
    return Header(Time(stamp // 10**9, stamp % 10**9), frame_id)


def image(pixels: NDArray[Any], encoding: str = "bgr8", stamp: int = 1, *, padding: int = 0, **fields: Any) -> Image:
    """An image message with these pixels (H, W) or (H, W, channels), whose rows end with bytes of padding."""
    height, width = pixels.shape[:2]
    rows = np.ascontiguousarray(pixels).view(np.uint8).reshape(height, -1)
    padded = np.pad(rows, ((0, 0), (0, padding)), constant_values=255)
    message = Image(header(stamp), height, width, encoding, 0, padded.shape[1], padded.tobytes())
    for name, value in fields.items():
        setattr(message, name, value)
    return message


def camera_info(camera: CameraParameters, stamp: int = 1) -> CameraInfo:
    """The message of a camera driver."""
    width, height = camera.size or (0, 0)
    return CameraInfo(
        header(stamp),
        height,
        width,
        model_name(camera),
        camera.distortion.tolist(),
        camera.matrix.ravel().tolist(),
        np.eye(3).ravel().tolist(),
        np.column_stack([camera.matrix, np.zeros(3)]).ravel().tolist(),
    )


class Camera:
    """A camera driver: publishes on one topic."""

    def __init__(
        self,
        middleware: Middleware,
        topic: str,
        message_type: Any = Image,
        qos: Qos = Qos(depth=5),  # noqa: B008
    ) -> None:
        self._publisher = middleware.publisher(topic, message_type, qos)

    def publish(self, *messages: Image | CompressedImage | CameraInfo) -> None:
        """Publish messages at once."""
        self._publisher.publish([cdr.encode(message) for message in messages])


@contextmanager
def publishing(node: Middleware, topics: Mapping[str, Any], make: Callable[[int], Iterable[Any]]) -> Iterator[None]:
    """Publish numbered messages, one on each topic of a type, again and again until the block ends."""
    cameras = [Camera(node, topic, kind) for topic, kind in topics.items()]

    def publish(number: int) -> None:
        for camera, message in zip(cameras, make(number), strict=True):
            camera.publish(message)

    with repeated(publish):
        yield
