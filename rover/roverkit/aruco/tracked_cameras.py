"""Cameras of ``roverlink aruco track``: one that the options describe, or those of a file ``cameras.yaml``."""

from __future__ import annotations

import argparse
import itertools
import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import cast

from roverkit.node.camera_source import (
    CAMERA_FRAME,
    PARAMETERS,
    SETTINGS,
    open_source,
    settings_of,
    source_of,
)
from roverkit.node.ros_connection import RosConnection, full_topic
from roverkit.vision import CameraParameters
from roverkit.vision.camera.cameras_file import SUFFIXES, CameraEntry, read_cameras
from roverkit.vision.camera.image_size import for_images
from roverkit.vision.camera.parameters_file import read_parameters
from roverkit.vision.frames import Frame, FrameSource, TopicSource, play
from roverkit.vision.frames.interleaving import in_order, newest
from roverkit.vision.frames.open_source import TOPIC
from roverkit.vision.frames.topic_source import CameraInfos
from roverlink.runtime.core.errors import SetupError

_IN_THE_FILE = {"parameters": "parameters", "camera_info": "camera_info", "camera_frame": "frame"} | {
    name: name for name in ("readout_time", *SETTINGS)
}
"""Options for one camera, each with the key that replaces it in a file of cameras."""


@dataclass(slots=True, eq=False)
class TrackedCamera:
    """Camera that is open, with its parameters for the size of its images."""

    entry: CameraEntry
    source: FrameSource
    parameters: CameraParameters
    changed: Callable[[], CameraParameters | None] = lambda: None
    """Function that returns other parameters if the camera has them now."""

    @property
    def name(self) -> str:
        """Name of the camera; empty if it is the only one and has none."""
        return self.entry.name

    def named(self, frame: Frame) -> Frame:
        """Return a frame with the name of the camera's coordinate frame."""
        default = f"{self.name}_optical_frame" if self.name else CAMERA_FRAME
        return replace(frame, frame_id=self.entry.frame or frame.frame_id or default)


def described(arguments: argparse.Namespace, say: Callable[[str], None]) -> list[CameraEntry]:
    """Return what the options, or the file that they name, say about the cameras. Raises `SetupError` for mistakes."""
    text = source_of(arguments, say)
    if Path(text).suffix.lower() not in SUFFIXES:
        if arguments.camera_info and (arguments.parameters or not text.startswith(TOPIC)):
            what = "--parameters is given" if arguments.parameters else f"the source is not {TOPIC}NAME"
            raise SetupError(f"--camera-info has no effect, because {what}; remove one of the options")
        frame, info = arguments.camera_frame or "", arguments.camera_info or ""
        return [
            CameraEntry("", text, arguments.parameters, frame, info, settings_of(arguments), arguments.readout_time)
        ]
    for option, key in _IN_THE_FILE.items():
        if getattr(arguments, option):
            name = option.replace("_", "-")
            raise SetupError(f"--{name} has no effect with a file of cameras; write '{key}' into {text}")
    return read_cameras(Path(text))


class CameraOpener:
    """Opens cameras. All of them end with a stack of contexts."""

    def __init__(
        self,
        arguments: argparse.Namespace,
        ros: RosConnection,
        logger: logging.Logger,
        stack: ExitStack,
    ) -> None:
        """Open cameras with the options."""
        self._arguments, self._ros, self._logger, self._stack = arguments, ros, logger, stack

    def open(self, entry: CameraEntry) -> TrackedCamera:
        """Open a camera, and read its parameters. Raises `SetupError` if that fails, or if they do not fit."""
        warn = self._logger.warning
        camera, infos = self._of_file(entry), None
        size = camera.size if camera else None
        source = self._stack.enter_context(open_source(entry.source, entry.settings, self._ros, size, warn))
        size = next(iter(source)).size
        self._logger.info("%s: %dx%d pixels", source.name, *size)
        origin = str(entry.parameters or PARAMETERS)
        if camera is None:
            images = cast(TopicSource, source)
            origin = (
                full_topic(entry.camera_info, self._ros.arguments) if entry.camera_info else images.camera_info_topic
            )
            other = f"'parameters' of {entry.name}" if entry.name else "--camera-info TOPIC or --parameters FILE"
            self._logger.info("camera parameters: from %s; %s overrides this", origin, other)
            infos = self._stack.enter_context(images.camera_infos(origin))
            camera = infos.first()
        # Only now: the size is known from the first frame, since a camera may not give the size that was requested.
        camera = for_images(camera, size, origin, rescale=self._arguments.rescale, warn=warn)
        return TrackedCamera(
            entry, source, camera, partial(self._changed, infos, size, origin) if infos else lambda: None
        )

    def _changed(self, infos: CameraInfos, size: tuple[int, int], origin: str) -> CameraParameters | None:
        """Return the newest parameters of a topic, if they are others and fit the images; log every change."""
        warn = self._logger.warning
        try:
            camera = infos.changed()
            if camera is None:
                return None
            camera = for_images(camera, size, origin, rescale=self._arguments.rescale, warn=warn)
        except SetupError as error:
            warn("the parameters of the camera have changed, and cannot be used; keeping the earlier ones: %s", error)
            return None
        warn("%s: the parameters of the camera have changed; poses use the new ones from now on", origin)
        return camera

    @staticmethod
    def _of_file(entry: CameraEntry) -> CameraParameters | None:
        """Return the parameters in the camera's file; None if it is a ROS 2 topic that has to give them."""
        if entry.parameters is None and entry.source.startswith(TOPIC):
            return None
        if entry.parameters is None and entry.name:
            raise SetupError(f"camera {entry.name} has no parameters; add 'parameters: FILE' (see aruco calibrate)")
        return read_parameters(entry.parameters or PARAMETERS)


def frames_of(
    cameras: Sequence[TrackedCamera], arguments: argparse.Namespace, ros: RosConnection
) -> Iterator[tuple[TrackedCamera, Frame]]:
    """Yield the frames of all cameras, at most ``--count``, each with its camera.

    The frames of recordings come at full speed. But they come in real time if they are also published or repeated.
    """
    recorded = [not camera.source.live for camera in cameras]
    if any(recorded) and not all(recorded):
        live = cameras[recorded.index(False)]
        raise SetupError(
            f"{live.source.name} is live and {cameras[recorded.index(True)].source.name} is a recording; their stamps "
            "do not fit each other: use one kind of source"
        )
    played = all(recorded) and (arguments.middleware or arguments.loop)
    streams = [
        map(camera.named, play(camera.source, loop=arguments.loop, clock=ros.clock) if played else iter(camera.source))
        for camera in cameras
    ]
    # One stream needs no thread, and none of its frames may be skipped.
    merged = newest(streams) if len(streams) > 1 and (played or not all(recorded)) else in_order(streams)
    for index, frame in itertools.islice(merged, arguments.count):
        yield cameras[index], frame
