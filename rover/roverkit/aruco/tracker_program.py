"""Program of ``roverlink aruco track``: it reads frames, and writes poses to ROS 2, JSON and a video."""

from __future__ import annotations

import roverkit.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

import argparse
import json
import logging
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import fields
from functools import cache
from pathlib import Path

from roverkit.aruco.landmark_publisher import LandmarkPublisher
from roverkit.aruco.rover_pose_publisher import RoverFrames, RoverPosePublisher
from roverkit.aruco.rover_position_publisher import position_publisher
from roverkit.aruco.target_parameters import TargetParameters
from roverkit.aruco.tracked_cameras import CameraOpener, TrackedCamera, described, frames_of
from roverkit.aruco.tracking_log import TrackingLog
from roverkit.node.camera_source import with_progress
from roverkit.node.program import project_registry
from roverkit.node.ros_connection import RosConnection
from roverkit.vision import Tracker
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.camera.uncertainty import Uncertainty
from roverkit.vision.frames import Frame
from roverkit.vision.frames.open_source import TOPIC
from roverkit.vision.images.drawing import draw, write_above
from roverkit.vision.images.film import Film
from roverkit.vision.localization.field_tracker import FieldTracker, LandmarkResult, MountedCamera
from roverkit.vision.markers.detection import Image
from roverkit.vision.poses.pose import Pose
from roverkit.vision.poses.transform_tree import TransformTree
from roverkit.vision.ros.mounts import MountOnTf
from roverlink.console import OK, NoProjectError
from roverlink.node_log import publish_log
from roverlink.runtime.ros_arguments.ros_args import RosArguments

Output = Callable[[LandmarkResult], None]


def track(arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger) -> int:
    """Track markers until the source of frames ends, and return the exit code.

    Raises `SetupError` if a file, the source of frames or a package is missing, or if a file is wrong.
    """
    wanted = TargetParameters(arguments, ros, logger)
    entries = described(arguments, logger.warning)
    with ExitStack() as stack:
        connection = RosConnection(ros, arguments.middleware or "auto", stack, logger.warning, wanted)
        opener = CameraOpener(arguments, connection, logger, stack)
        cameras = [opener.open(entry) for entry in entries]
        targets = wanted.targets
        located = targets.landmarks is not None

        def tracker(camera: TrackedCamera) -> Tracker:
            uncertainty = _uncertainty(arguments, camera.entry.readout_time)
            return Tracker(camera.parameters, targets.markers, scan_s=arguments.scan_period, uncertainty=uncertainty)

        hears_ros = arguments.middleware or any(entry.source.startswith(TOPIC) for entry in entries)
        ros_of_mounts = connection if hears_ros else None
        mounted = {
            camera.name: MountedCamera(
                tracker(camera), camera.name, _mount(camera, ros_of_mounts, arguments, logger, now=located)
            )
            for camera in cameras
        }
        field_tracker = FieldTracker(sum(bool(ros_of_mounts or entry.mount) for entry in entries), targets.landmarks)
        outputs = [output for camera in cameras for output in _files(camera, arguments, stack)]
        if arguments.middleware:
            stack.enter_context(publish_log(logger, connection.middleware, ros))
            outputs += [_publisher(camera, connection, arguments, logger) for camera in cameras]
            outputs.append(_rover_publisher(connection, arguments, logger, now=located))
        log = stack.enter_context(TrackingLog(logger, targets.markers, wanted.assumed_side))
        frames = frames_of(cameras, arguments, connection)
        for camera, frame in log.timed(with_progress(frames, [camera.source for camera in cameras], arguments)):
            if wanted.targets is not targets:
                targets = wanted.targets
                for tracked in cameras:
                    mounted[tracked.name].tracker = tracker(tracked)
                field_tracker.use(targets.landmarks)
                log.look_for(targets.markers, wanted.assumed_side)
            if parameters := camera.changed():
                camera.parameters = parameters
                mounted[camera.name].tracker.use(parameters)
            result = field_tracker.track(mounted[camera.name], frame)
            log.add(result)
            if arguments.json:
                print(json.dumps(result.as_dict()), flush=True)
            for output in outputs:
                output(result)
    return OK


def _uncertainty(arguments: argparse.Namespace, readout_time: float | None) -> Uncertainty:
    options = {field.name: getattr(arguments, field.name) for field in fields(Uncertainty)}
    options["readout_time"] = readout_time
    return Uncertainty(**{name: value for name, value in options.items() if value is not None})


def _mount(
    camera: TrackedCamera,
    ros: RosConnection | None,
    arguments: argparse.Namespace,
    logger: logging.Logger,
    *,
    now: bool,
) -> Callable[[Frame], Pose | None]:
    """Return a function that returns the mount of a camera: that of the file of cameras, or else the one on /tf.

    ``ros`` is None if the program hears nothing of ROS 2. With ``now``, the transforms are received at once, and
    otherwise when the mount is asked for.
    """
    mount = camera.entry.mount
    if mount is not None or ros is None:
        if mount is None and camera.name and now:
            logger.warning(
                "camera %s has no mount, so the pose of the rover is computed without it; add 'mount' to %s",
                camera.name,
                arguments.source,
            )
        return lambda _: mount
    on_tf = cache(lambda: MountOnTf(ros.transforms, arguments.base_frame, logger.warning))
    if now:
        on_tf()
    return lambda frame: on_tf()(frame)


def _of(camera: TrackedCamera, output: Output) -> Output:
    """Return an output that gets only the results of one camera."""
    return lambda result: output(result) if result.camera == camera.name else None


def _files(camera: TrackedCamera, arguments: argparse.Namespace, stack: ExitStack) -> Iterator[Output]:
    if arguments.save:
        path: Path = arguments.save
        own = path.with_stem(f"{path.stem}_{camera.name}") if camera.name else path
        film = stack.enter_context(Film(own, camera.source.rate, camera.entry.source))
        yield _of(camera, lambda result: film.add(_drawn(result), result.frame.stamp))


def _publisher(
    camera: TrackedCamera, ros: RosConnection, arguments: argparse.Namespace, logger: logging.Logger
) -> Output:
    """Return an output that publishes the results of one camera; the names of several cameras are in the topics."""

    def topic(name: str) -> str:
        return ros.topic(f"{camera.name}/{name}" if camera.name and not name.startswith("/") else name)

    # A frame has one parent on /tf, so a marker that two cameras see needs two frames.
    prefix = f"{camera.name}_{arguments.marker_frame}" if camera.name else arguments.marker_frame
    return _of(camera, LandmarkPublisher(ros.middleware, prefix, topic, logger.warning).publish)


def _rover_publisher(ros: RosConnection, arguments: argparse.Namespace, logger: logging.Logger, *, now: bool) -> Output:
    """Return an output that publishes the rover's pose, if the landmarks agree, and sends it to the basestation.

    With ``now``, the topics are there at once, and otherwise with the first pose.
    """

    @cache
    def publishers() -> tuple[RoverPosePublisher, Callable[[Floats], None]]:
        frames = RoverFrames(arguments.base_frame, arguments.odom_frame or "")
        tree = ros.transforms if frames.odom else TransformTree()
        poses = RoverPosePublisher(ros.middleware, frames, tree, ros.topic, logger.warning)
        try:
            registry = project_registry(arguments)
        except NoProjectError as error:  # tracking works without a bridge
            logger.warning("the rover's position is not sent to the basestation: %s", error)
            return poses, lambda _: None
        return poses, position_publisher(ros.middleware, registry, ros.topic, logger.warning)

    def publish(result: LandmarkResult) -> None:
        if result.rover and result.rover.field_pose.agreed:
            poses, publish_position = publishers()
            poses.publish(result.rover)
            publish_position(result.rover.field_pose.pose.translation)

    if now:
        publishers()
    return publish


def _drawn(result: LandmarkResult) -> Image:
    """Return the image of a film: a frame with its landmarks, its stamp in seconds, and its coordinate frame."""
    frame = result.frame
    stamp = f"{frame.stamp // 10**9}.{frame.stamp % 10**9:09d}"
    drawn = draw(frame.image, result.parameters, result.detections, result.camera_pose)
    return write_above(drawn, f"{stamp} {frame.frame_id}")
