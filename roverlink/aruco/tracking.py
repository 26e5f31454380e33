"""Implementation of ``roverlink aruco track``: reads frames, and writes poses to ROS 2, JSON and a video."""

from __future__ import annotations

import roverlink.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

import argparse
import json
import logging
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import fields
from functools import cache
from pathlib import Path

from roverlink.aruco.tracked_cameras import CameraOpener, TrackedCamera, described, frames_of
from roverlink.aruco.tracking_log import TrackingLog
from roverlink.console import OK, NoProjectError, project_folder
from roverlink.generated_code import load_project
from roverlink.node_log import publish_log
from roverlink.progress import progress
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.middleware import Middleware, open_middleware
from roverlink.runtime.ros_arguments.ros_args import RosArguments
from roverlink.vision import CameraParameters, Landmarks, MarkerSet, Tracker, read_landmarks
from roverlink.vision.camera.uncertainty import Uncertainty
from roverlink.vision.field.view import Eye, Lookout, View
from roverlink.vision.frames import Frame
from roverlink.vision.frames.open_source import TOPIC
from roverlink.vision.images.drawing import draw, write_above
from roverlink.vision.images.film import Film
from roverlink.vision.markers.boards import read_boards
from roverlink.vision.markers.detection import Image
from roverlink.vision.markers.marker_set import SIDE
from roverlink.vision.poses.pose import Pose
from roverlink.vision.poses.transform_tree import TransformTree
from roverlink.vision.ros.mounts import MountOnTf
from roverlink.vision.ros.publishing import Publishing
from roverlink.vision.ros.rover_pose import RoverFrames, RoverPublishing
from roverlink.vision.ros.rover_position import position_publisher
from roverlink.vision.ros.transform_listener import TransformListener

Output = Callable[[View], None]


def track(arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger) -> int:
    """Track markers until the source of frames ends, and return the exit code.

    Raises `SetupError` if a file, the source of frames or a package is missing, or if a file is wrong.
    """
    markers, uncertainty = _markers(arguments), _uncertainty(arguments)
    landmarks = _landmarks(arguments, markers)
    entries = described(arguments, logger.warning)
    with ExitStack() as stack:

        @cache
        def middleware() -> Middleware:
            return stack.enter_context(open_middleware(arguments.middleware or "auto", ros.node))

        def tracker(camera: CameraParameters) -> Tracker:
            return Tracker(camera, markers, scan_every=arguments.scan_every, uncertainty=uncertainty)

        @cache
        def transforms() -> TransformTree:
            return TransformListener(middleware(), ros.topic, logger.warning).tree

        def mount_of(camera: TrackedCamera) -> Callable[[Frame], Pose | None]:
            hears_ros = arguments.middleware or any(one.source.startswith(TOPIC) for one in entries)
            if camera.entry.mount is None and landmarks and hears_ros:
                return MountOnTf(transforms(), arguments.base_frame, logger.warning)
            return lambda _: camera.entry.mount

        opener = CameraOpener(arguments, ros, middleware, logger, stack)
        cameras = [opener.open(entry) for entry in entries]
        eyes = {one.name: Eye(tracker(one.parameters), one.name, mount_of(one)) for one in cameras}
        lookout = Lookout(len(cameras), landmarks)
        outputs = [output for camera in cameras for output in _files(camera, arguments, stack)]
        if arguments.middleware:
            stack.enter_context(publish_log(logger, middleware(), ros))
            outputs += [_publisher(camera, middleware(), arguments, ros, logger) for camera in cameras]
            if landmarks:
                outputs.append(_rover_publisher(middleware(), transforms, arguments, ros, logger))
        log = stack.enter_context(TrackingLog(logger, markers, {one.name: one.parameters for one in cameras}))
        for camera, frame in log.timed(_with_progress(frames_of(cameras, arguments), cameras, arguments)):
            view = lookout.view(eyes[camera.name], frame)
            log.add(view)
            if arguments.json:
                print(json.dumps(view.as_dict()), flush=True)
            for output in outputs:
                output(view)
    return OK


def _markers(arguments: argparse.Namespace) -> MarkerSet:
    sides = dict(arguments.side)
    boards = read_boards(arguments.boards) if arguments.boards else ()
    return MarkerSet(arguments.dictionary, sides.pop(None, SIDE), sides, boards)


def _uncertainty(arguments: argparse.Namespace) -> Uncertainty:
    options = {field.name: getattr(arguments, field.name) for field in fields(Uncertainty)}
    return Uncertainty(**{name: value for name, value in options.items() if value is not None})


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


def _with_progress(
    frames: Iterator[tuple[TrackedCamera, Frame]], cameras: Sequence[TrackedCamera], arguments: argparse.Namespace
) -> Iterator[tuple[TrackedCamera, Frame]]:
    """Yield the frames; show the progress if they end and the terminal does not show JSON."""
    totals = [camera.source.total for camera in cameras]
    known = [total for total in totals if total is not None]
    if arguments.loop or len(known) < len(totals) or (arguments.json and sys.stdout.isatty()):
        yield from frames
        return
    with progress(", ".join(camera.source.name for camera in cameras)) as report:
        for done, one in enumerate(frames, 1):
            yield one
            report(done, sum(known))


def _of(camera: TrackedCamera, output: Output) -> Output:
    """Return an output that gets only the results of one camera."""
    return lambda view: output(view) if view.camera == camera.name else None


def _files(camera: TrackedCamera, arguments: argparse.Namespace, stack: ExitStack) -> Iterator[Output]:
    if arguments.save:
        path: Path = arguments.save
        own = path.with_stem(f"{path.stem}_{camera.name}") if camera.name else path
        film = stack.enter_context(Film(own, camera.source.rate))
        yield _of(camera, lambda view: film.add(_drawn(view, camera), view.frame.stamp))


def _publisher(
    camera: TrackedCamera,
    middleware: Middleware,
    arguments: argparse.Namespace,
    ros: RosArguments,
    logger: logging.Logger,
) -> Output:
    """Return an output that publishes the results of one camera; the names of several cameras are in the topics."""

    def topic(name: str) -> str:
        return ros.topic(f"{camera.name}/{name}" if camera.name and not name.startswith("/") else name)

    # A frame has one parent on /tf, so a marker that two cameras see needs two frames.
    prefix = f"{camera.name}_{arguments.marker_frame}" if camera.name else arguments.marker_frame
    return _of(camera, Publishing(middleware, camera.parameters, prefix, topic, logger.warning).publish)


def _rover_publisher(
    middleware: Middleware,
    transforms: Callable[[], TransformTree],
    arguments: argparse.Namespace,
    ros: RosArguments,
    logger: logging.Logger,
) -> Output:
    """Return an output that publishes the rover's pose, if the landmarks agree, and sends it to the basestation."""
    frames = RoverFrames(arguments.base_frame, arguments.odom_frame or "")
    tree = transforms() if frames.odom else TransformTree()
    publish_pose = RoverPublishing(middleware, frames, tree, ros.topic, logger.warning).publish
    try:
        registry = load_project(project_folder(arguments.project))
        publish_position = position_publisher(middleware, registry, ros.topic, logger.warning)
    except NoProjectError as error:  # tracking works without a bridge
        logger.warning("the rover's position is not sent to the basestation: %s", error)
        publish_position = lambda _: None  # noqa: E731  # a def would repeat the type

    def publish(view: View) -> None:
        if view.rover and view.rover.place.agreed:
            publish_pose(view.rover)
            publish_position(view.rover.place.pose.translation)

    return publish


def _drawn(view: View, camera: TrackedCamera) -> Image:
    """Return the image of a film: a frame with its landmarks, its stamp in seconds, and its coordinate frame."""
    frame = view.frame
    stamp = f"{frame.stamp // 10**9}.{frame.stamp % 10**9:09d}"
    drawn = draw(frame.image, camera.parameters, view.sightings, view.place)
    return write_above(drawn, f"{stamp} {frame.frame_id}")
