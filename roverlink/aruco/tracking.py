"""Implementation of ``roverlink aruco track``: reads frames, and writes poses to ROS 2, JSON and a video."""

from __future__ import annotations

import roverlink.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

import argparse
import itertools
import json
import logging
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from functools import cache
from typing import cast

from roverlink.aruco.camera_source import CAMERA_FRAME, PARAMETERS, full_topic, open_source, source_of
from roverlink.aruco.tracking_log import TrackingLog
from roverlink.console import OK, NoProjectError, project_folder
from roverlink.generated_code import load_project
from roverlink.node_log import publish_log
from roverlink.progress import progress
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.middleware import Middleware, open_middleware
from roverlink.runtime.ros_arguments.ros_args import RosArguments
from roverlink.vision import CameraParameters, Landmarks, MarkerSet, Tracker, read_landmarks
from roverlink.vision.camera.image_size import for_images
from roverlink.vision.camera.parameters_file import read_parameters
from roverlink.vision.field.view import View, look
from roverlink.vision.frames import Frame, FrameSource, TopicSource, play
from roverlink.vision.frames.open_source import TOPIC
from roverlink.vision.images.drawing import draw, write_above
from roverlink.vision.images.film import Film
from roverlink.vision.markers.boards import read_boards
from roverlink.vision.markers.detection import Image
from roverlink.vision.markers.marker_set import SIDE
from roverlink.vision.ros.publishing import Publishing
from roverlink.vision.ros.rover_position import position_publisher

Output = Callable[[View], None]


def track(arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger) -> int:
    """Track markers until the source of frames ends, and return the exit code.

    Raises `SetupError` if a file, the source of frames or a package is missing, or if a file is wrong.
    """
    markers = _markers(arguments)
    landmarks = _landmarks(arguments, markers)
    text = source_of(arguments, logger.warning)
    camera = _parameters(arguments, text)
    with ExitStack() as stack:

        @cache
        def middleware() -> Middleware:
            return stack.enter_context(open_middleware(arguments.middleware or "auto", ros.node))

        size = camera.size if camera else None
        source = stack.enter_context(open_source(text, arguments, ros, middleware, size, logger.warning))
        size = next(iter(source)).size
        logger.info("%s: %dx%d pixels", source.name, *size)
        origin = str(arguments.parameters or PARAMETERS)
        if camera is None:
            images = cast(TopicSource, source)
            origin = full_topic(arguments.camera_info, ros) if arguments.camera_info else images.camera_info_topic
            logger.info("camera parameters: from %s; --camera-info TOPIC or --parameters FILE overrides this", origin)
            camera = images.read_camera(origin)
        # Only now: the size is known from the first frame, since a camera may not give the size that was requested.
        camera = for_images(camera, size, origin, rescale=arguments.rescale, warn=logger.warning)
        outputs = list(_outputs(arguments, source, camera, ros, logger, stack, middleware))
        log = stack.enter_context(TrackingLog(logger))
        for view in look(log.timed(_frames(source, arguments)), Tracker(camera, markers), landmarks):
            log.add(view)
            for output in outputs:
                output(view)
    return OK


def _markers(arguments: argparse.Namespace) -> MarkerSet:
    sides = dict(arguments.side)
    boards = read_boards(arguments.boards) if arguments.boards else ()
    return MarkerSet(arguments.dictionary, sides.pop(None, SIDE), sides, boards)


def _parameters(arguments: argparse.Namespace, source: str) -> CameraParameters | None:
    """Read the file of the camera's parameters; return None if it is a ROS 2 topic that has to give them."""
    if arguments.parameters is None and source.startswith(TOPIC):
        return None
    if arguments.camera_info:
        what = "--parameters is given" if arguments.parameters else f"the source is not {TOPIC}NAME"
        raise SetupError(f"--camera-info has no effect, because {what}; remove one of the options")
    return read_parameters(arguments.parameters or PARAMETERS)


def _landmarks(arguments: argparse.Namespace, markers: MarkerSet) -> Landmarks | None:
    if not arguments.landmarks:
        return None
    landmarks = read_landmarks(arguments.landmarks)
    for target in landmarks.places:
        if not markers.is_target(target):
            known = (
                "a known board; define it in the file of --boards"
                if isinstance(target, str)
                else f"a known single marker; it is on a board, or {arguments.dictionary} does not contain it"
            )
            raise SetupError(f"{arguments.landmarks}: landmark {target!r} is not {known}")
    return landmarks


def _frames(source: FrameSource, arguments: argparse.Namespace) -> Iterator[Frame]:
    """Yield the frames of the source, at most ``--count``.

    The frames of a recording come at full speed. But they come in real time if they are also published or repeated.
    """
    played = not source.live and (arguments.middleware or arguments.loop)
    frames = play(source, loop=arguments.loop) if played else iter(source)
    frames = (_named(frame, arguments.camera_frame) for frame in itertools.islice(frames, arguments.count))
    if arguments.loop or source.total is None or (arguments.json and sys.stdout.isatty()):
        yield from frames
        return
    with progress(source.name) as report:
        for done, frame in enumerate(frames, 1):
            yield frame
            report(done, source.total)


def _named(frame: Frame, given: str | None) -> Frame:
    """Return a frame with the name of the camera's coordinate frame, which may be given."""
    return replace(frame, frame_id=given or frame.frame_id or CAMERA_FRAME)


def _outputs(
    arguments: argparse.Namespace,
    source: FrameSource,
    camera: CameraParameters,
    ros: RosArguments,
    logger: logging.Logger,
    stack: ExitStack,
    open_middleware: Callable[[], Middleware],
) -> Iterator[Output]:
    if arguments.json:
        yield lambda view: print(json.dumps(view.as_dict()), flush=True)
    if arguments.save:
        film = stack.enter_context(Film(arguments.save, source.rate))
        yield lambda view: film.add(_drawn(view, camera), view.frame.stamp)
    if arguments.middleware:
        middleware = open_middleware()
        stack.enter_context(publish_log(logger, middleware, ros))
        yield Publishing(middleware, camera, arguments.marker_frame, ros.topic, logger.warning).publish
        if arguments.landmarks:
            try:
                registry = load_project(project_folder(arguments.project))
            except NoProjectError as error:  # tracking works without a bridge
                logger.warning("the rover's position is not sent to the basestation: %s", error)
                return
            publish_position = position_publisher(middleware, registry, ros.topic, logger.warning)
            yield lambda view: publish_position(view.place.pose.translation) if view.place else None


def _drawn(view: View, camera: CameraParameters) -> Image:
    """Return the image of a film: a frame with its landmarks, its stamp in seconds, and its coordinate frame."""
    frame = view.frame
    stamp = f"{frame.stamp // 10**9}.{frame.stamp % 10**9:09d}"
    return write_above(draw(frame.image, camera, view.sightings, view.place), f"{stamp} {frame.frame_id}")
