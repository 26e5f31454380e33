"""Depth camera: the topics of its depth, which is aligned to its colour images, and the newest depth images."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from roverkit.node.ros_connection import RosConnection
from roverkit.vision import CameraParameters
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.frames import TopicSets
from roverkit.vision.frames.live import STALLED_S
from roverkit.vision.frames.topic_sets import LOOK_S, Arrived
from roverkit.vision.ros.camera_info import camera_info_topic, camera_of, is_rectified
from roverkit.vision.ros.image_messages import ImageMessage
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError, MiddlewareError, RoverlinkError, SetupError
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo
from roverlink.runtime.interfaces.std_msgs import Header
from roverlink.runtime.ros_time.headers import stamp_of

_ALIGNED = "aligned_depth_to_"  # of realsense2_camera
_SLOP_NS = 100_000_000
"""Largest distance of the stamps of depth and camera parameters, which seldom change."""
_KEPT = 10
"""Number of depth images that are kept; the search for objects in a colour image may last for so many."""


class NoDepthError(RoverlinkError):
    """No depth image came, or none that can be used."""


@dataclass(frozen=True, slots=True, eq=False)
class CameraTopics:
    """Fully qualified topics of one camera."""

    colour: str
    depth: str
    info: str


@dataclass(frozen=True, slots=True, eq=False)
class DepthImage:
    """Depth image with the parameters of the colour camera to which it is aligned."""

    depth: Floats
    """Depth (H, W) in metres; NaN or 0 where it is missing."""
    camera: CameraParameters
    stamp: int
    """Time of the image in nanoseconds since 1970."""


@dataclass(frozen=True, slots=True, eq=False)
class _Received:
    """Depth image with camera parameters, serialized."""

    topics: CameraTopics
    at: float
    """Time of the arrival in seconds of a steady clock."""
    stamp: int
    messages: tuple[Arrived, ...]


class DepthCamera:
    """Newest depth images of a camera."""

    def __init__(
        self, connection: RosConnection, topics: Callable[[], CameraTopics], say: Callable[[str], None]
    ) -> None:
        """Prepare; ``topics`` returns the camera's topics, ``say`` is called with messages for the user."""
        self._connection, self._topics, self._say = connection, topics, say
        self._received: deque[_Received] = deque(maxlen=_KEPT)
        self._ended = False

    def receive(self) -> None:
        """Receive images until the program ends. Raises `MiddlewareError` if a topic has messages of another type."""
        while not self._ended:
            topics = self._topics()
            with TopicSets(self._connection.middleware, [topics.depth, topics.info], self._say, _SLOP_NS) as sets:
                while self._topics() is topics and not self._ended:
                    found = sets.take(LOOK_S)
                    if found is not None:
                        stamp = stamp_of(cdr.decode(Header, found[1][0].data))
                        self._received.append(_Received(topics, time.monotonic(), stamp, found[1]))

    @contextmanager
    def in_background(self) -> Iterator[None]:
        """Receive images on a thread until the context ends. If a topic has messages of another type, say it."""

        def run() -> None:
            try:
                self.receive()
            except MiddlewareError as error:
                self._say(f"no depth: {error}")

        thread = threading.Thread(target=run, name="depth")
        thread.start()
        try:
            yield
        finally:
            self._ended = True
            thread.join()

    def image(self, stamp: int | None = None) -> DepthImage:
        """Return the newest depth image, or the one that is nearest to a time in nanoseconds.

        Raises `NoDepthError` if there is none, or none that can be used.
        """
        topics, now = self._topics(), time.monotonic()
        fresh = [kept for kept in tuple(self._received) if kept.topics is topics and now - kept.at <= STALLED_S]
        if not fresh:
            raise NoDepthError(
                f"for {STALLED_S:g} s, no depth came on {topics.depth} with camera parameters on {topics.info}"
            )
        chosen = fresh[-1] if stamp is None else min(fresh, key=lambda received: abs(received.stamp - stamp))
        try:
            return _read(chosen.messages, is_rectified(topics.colour))
        except (ConversionError, SetupError) as error:
            raise NoDepthError(f"{topics.depth}, {topics.info}: {error}") from error


def _read(arrived: Sequence[Arrived], rectified: bool) -> DepthImage:
    """Return the depth image of a set of messages. Raises `ConversionError` or `SetupError` if it cannot be used."""
    depth, info = (message.read() for message in arrived)
    if not isinstance(depth, ImageMessage) or not isinstance(info, CameraInfo):
        raise ConversionError("the first topic must have images, and the second one camera parameters")
    return DepthImage(depth.depth(), camera_of(info, rectified), depth.stamp)


def aligned_depth_topic(colour: str) -> str:
    """Return the topic on which realsense2_camera publishes the depth that is aligned to the images of a topic.

    Raises `SetupError` if the name of the topic does not follow that driver's rule.
    """
    camera, _, stream = camera_info_topic(colour).rpartition("/")[0].rpartition("/")
    if not stream:
        raise SetupError(f"the topic of the depth that is aligned to {colour} is not known; name it with --depth TOPIC")
    return f"{camera}/{_ALIGNED}{stream}/image_raw"
