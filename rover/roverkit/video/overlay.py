"""Overlay of a stream: the time, detected objects, and the quality of the link, drawn into the images."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from datetime import datetime

from roverkit.objects.detected_objects import TrackedObject
from roverkit.video.link_quality import LinkQuality
from roverkit.video.video_declarations import OBJECTS
from roverkit.vision.ros.object_messages import objects_of
from roverlink.nodes import FullName
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError, MiddlewareError
from roverlink.runtime.interfaces.vision_msgs import Detection2DArray
from roverlink.runtime.middleware import Middleware

_OLD_S = 1.0


class SeenObjects:
    """Objects that ``roverlink objects track`` has published last."""

    def __init__(self, middleware: Middleware, full_name: FullName, say: Callable[[str], None]) -> None:
        """Listen; `say` is called with a message if ROS 2 has no message type for the objects."""
        self._objects: list[TrackedObject] = []
        self._at = 0.0
        try:
            OBJECTS.subscribe(middleware, full_name, self._take)
        except MiddlewareError as error:
            say(f"the detected objects are not received: {error}")

    def now(self) -> list[TrackedObject]:
        """Return the objects; none if they are older than a second."""
        return self._objects if time.monotonic() - self._at < _OLD_S else []

    def _take(self, messages: Sequence[bytes]) -> None:
        try:
            self._objects = objects_of(cdr.decode(Detection2DArray, messages[-1]))
        except ConversionError:  # not written by a ROS 2 node
            return
        self._at = time.monotonic()


def time_text(stamp: int) -> str:
    """Return the time of an image, which is in nanoseconds since 1970, in the local time zone."""
    return f"{datetime.fromtimestamp(stamp / 1e9):%H:%M:%S.%f}"[:-3]


def link_text(quality: LinkQuality | None) -> str:
    """Return the line about the link."""
    if quality is None:
        return "link: unknown"
    trip = "" if quality.round_trip is None else f", {1e3 * quality.round_trip:.0f} ms"
    return f"link: {quality.loss:.0%} lost{trip}"
