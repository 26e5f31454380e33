"""Depth camera of ``roverlink rocks measure``: its topics, which ROS 2 can change, and its newest depth image."""

from __future__ import annotations

import argparse
import logging
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from roverlink.declared_parameters import DeclaredParameters
from roverlink.ros_connection import RosConnection, full_topic
from roverlink.runtime.core.errors import ConversionError, SetupError
from roverlink.runtime.interfaces.rcl_interfaces import ParameterValue
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo
from roverlink.runtime.ros_arguments.ros_args import RosArguments
from roverlink.vision import CameraParameters
from roverlink.vision.camera.camera_model import Floats
from roverlink.vision.frames import TopicSets
from roverlink.vision.frames.live import STALLED_S
from roverlink.vision.frames.topic_sets import LOOK_S, Arrived
from roverlink.vision.rocks import Unmeasurable, UnmeasurableError
from roverlink.vision.ros.camera_info import camera_info_topic, camera_of, is_rectified
from roverlink.vision.ros.image_messages import ImageMessage

_ALIGNED = "aligned_depth_to_"  # of realsense2_camera
_DESCRIPTIONS = {
    "camera": (ParameterValue.STRING, "topic with the colour images in which the operator draws the line"),
    "depth": (
        ParameterValue.STRING,
        "topic with the depth that is aligned to the colour images; empty for the default",
    ),
    "camera_info": (ParameterValue.STRING, "topic with the parameters of the colour camera; empty for the default"),
}
_SLOP_NS = 100_000_000
"""Largest distance of the stamps of depth and camera parameters, which seldom change."""


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


class CameraTopicParameters(DeclaredParameters[CameraTopics]):
    """Parameters of the node: the topics of the camera. Another ``camera`` sets the other ones to their defaults."""

    def __init__(self, arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger) -> None:
        """Read the first values. Raises `SetupError` if one of them is not the name of a topic."""
        options = {name: getattr(arguments, name) or "" for name in _DESCRIPTIONS}

        def read(values: Mapping[str, Any]) -> CameraTopics:
            colour = full_topic(values["camera"], ros)
            depth = values["depth"] or _aligned_depth_topic(colour)
            info = values["camera_info"] or camera_info_topic(colour)
            return CameraTopics(colour, full_topic(depth, ros), full_topic(info, ros))

        super().__init__(_DESCRIPTIONS, options, ros, read, logger)

    def _completed(self, before: Mapping[str, Any], changes: Mapping[str, Any]) -> Mapping[str, Any]:
        # The depth of one camera with the parameters of another one would give wrong sizes.
        others = {"depth": "", "camera_info": ""} if "camera" in changes else {}
        return {**before, **others, **changes}


class DepthCamera:
    """Newest depth image of a camera."""

    def __init__(
        self, connection: RosConnection, topics: Callable[[], CameraTopics], say: Callable[[str], None]
    ) -> None:
        """Prepare; ``topics`` returns the camera's topics, ``say`` is called with messages for the user."""
        self._connection, self._topics, self._say = connection, topics, say
        self._newest: tuple[CameraTopics, float, tuple[Arrived, ...]] | None = None

    def receive(self) -> None:
        """Receive images until the program ends. Raises `MiddlewareError` if a topic has messages of another type."""
        while True:
            topics = self._topics()
            with TopicSets(self._connection.middleware, [topics.depth, topics.info], self._say, _SLOP_NS) as sets:
                while self._topics() is topics:
                    found = sets.take(LOOK_S)
                    if found is not None:
                        self._newest = topics, time.monotonic(), found[1]

    def image(self) -> DepthImage:
        """Return the newest depth image. Raises `UnmeasurableError` if there is none, or none that can be used."""
        topics, newest = self._topics(), self._newest
        if newest is None or newest[0] is not topics or time.monotonic() - newest[1] > STALLED_S:
            raise UnmeasurableError(
                Unmeasurable.NO_IMAGE,
                f"for {STALLED_S:g} s, no depth came on {topics.depth} with camera parameters on {topics.info}",
            )
        try:
            return _read(newest[2], is_rectified(topics.colour))
        except (ConversionError, SetupError) as error:
            raise UnmeasurableError(Unmeasurable.NO_IMAGE, f"{topics.depth}, {topics.info}: {error}") from error


def _read(arrived: Sequence[Arrived], rectified: bool) -> DepthImage:
    """Return the depth image of a set of messages. Raises `ConversionError` or `SetupError` if it cannot be used."""
    depth, info = (one.read() for one in arrived)
    if not isinstance(depth, ImageMessage) or not isinstance(info, CameraInfo):
        raise ConversionError("the first topic must have images, and the second one camera parameters")
    return DepthImage(depth.depth(), camera_of(info, rectified), depth.stamp)


def _aligned_depth_topic(colour: str) -> str:
    """Return the topic on which realsense2_camera publishes the depth that is aligned to the images of a topic.

    Raises `SetupError` if the name of the topic does not follow that driver's rule.
    """
    camera, _, stream = camera_info_topic(colour).rpartition("/")[0].rpartition("/")
    if not stream:
        raise SetupError(f"the topic of the depth that is aligned to {colour} is not known; name it with --depth TOPIC")
    return f"{camera}/{_ALIGNED}{stream}/image_raw"
