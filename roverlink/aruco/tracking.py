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

from roverlink.aruco.camera_source import open_source
from roverlink.aruco.tracking_log import TrackingLog
from roverlink.console import OK, NoProjectError, project_folder
from roverlink.generated_code import load_project
from roverlink.node_log import publish_log
from roverlink.progress import progress
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.middleware import open_middleware
from roverlink.runtime.ros_arguments.ros_args import RosArguments
from roverlink.vision import CameraParameters, Landmarks, MarkerSet, Tracker, read_landmarks
from roverlink.vision.camera.image_size import for_images
from roverlink.vision.camera.parameters_file import read_parameters
from roverlink.vision.field.view import View, look
from roverlink.vision.frames import Frame, FrameSource, play
from roverlink.vision.images.drawing import draw
from roverlink.vision.images.film import Film
from roverlink.vision.markers.boards import read_boards
from roverlink.vision.markers.marker_set import SIDE
from roverlink.vision.ros.publishing import Publishing
from roverlink.vision.ros.rover_position import position_publisher
from roverlink.vision.ros.sighting_messages import FrameNames

Output = Callable[[View], None]


def track(arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger) -> int:
    """Track markers until the source of frames ends, and return the exit code.

    Raises `SetupError` if a file, the source of frames or a package is missing, or if a file is wrong.
    """
    camera, markers = read_parameters(arguments.parameters), _markers(arguments)
    landmarks = _landmarks(arguments, markers)
    with ExitStack() as stack:
        source = stack.enter_context(open_source(arguments, camera.size, logger.warning))
        size = next(iter(source)).size
        logger.info("%s: %dx%d pixels", source.name, *size)
        # Only now: the size is known from the first frame, since a camera may not give the size that was requested.
        camera = for_images(camera, size, str(arguments.parameters), rescale=arguments.rescale, warn=logger.warning)
        outputs = list(_outputs(arguments, source, camera, ros, logger, stack))
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
    frames = itertools.islice(frames, arguments.count)
    if arguments.loop or source.total is None or (arguments.json and sys.stdout.isatty()):
        yield from frames
        return
    with progress(source.name) as report:
        for done, frame in enumerate(frames, 1):
            yield frame
            report(done, source.total)


def _outputs(
    arguments: argparse.Namespace,
    source: FrameSource,
    camera: CameraParameters,
    ros: RosArguments,
    logger: logging.Logger,
    stack: ExitStack,
) -> Iterator[Output]:
    if arguments.json:
        yield lambda view: print(json.dumps(view.as_dict()), flush=True)
    if arguments.save:
        film = stack.enter_context(Film(arguments.save, source.rate))
        yield lambda view: film.add(draw(view.frame.image, camera, view.sightings, view.place), view.frame.stamp)
    if arguments.middleware:
        middleware = stack.enter_context(open_middleware(arguments.middleware, ros.node))
        stack.enter_context(publish_log(logger, middleware, ros))
        names = FrameNames(arguments.camera_frame, arguments.marker_frame)
        yield Publishing(middleware, camera, names, ros.topic, logger.warning).publish
        if arguments.landmarks:
            try:
                registry = load_project(project_folder(arguments.project))
            except NoProjectError as error:  # tracking works without a bridge
                logger.warning("the rover's position is not sent to the basestation: %s", error)
                return
            publish_position = position_publisher(middleware, registry, ros.topic, logger.warning)
            yield lambda view: publish_position(view.place.pose.translation) if view.place else None
