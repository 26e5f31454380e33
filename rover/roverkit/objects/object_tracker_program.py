"""Program of ``roverlink objects track``: it reads frames, and writes objects to ROS 2, JSON and a video."""

from __future__ import annotations

import roverkit.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

import argparse
import itertools
import json
import logging
import secrets
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from typing import Any

from roverkit.node.camera_source import CAMERA_FRAME, open_source, settings_of, source_of, with_progress
from roverkit.node.program import project_registry
from roverkit.node.ros_connection import RosConnection, full_topic
from roverkit.objects.chosen_detector import open_detector
from roverkit.objects.detected_objects import TrackedObject, as_json, rounded
from roverkit.objects.location import Location, locate
from roverkit.objects.object_declarations import DETECTIONS, DETECTIONS_3D, IMAGE
from roverkit.objects.object_log import ObjectLog
from roverkit.objects.object_rows import DetectedObjectRow
from roverkit.objects.object_tracker import ObjectTracker
from roverkit.objects.object_types import ClassesFile, ObjectTypes
from roverkit.vision.frames import Frame, FrameSource, ImageFiles, TopicSource, play
from roverkit.vision.frames.depth_camera import CameraTopics, DepthCamera, NoDepthError, aligned_depth_topic
from roverkit.vision.images.film import Film
from roverkit.vision.images.object_drawing import draw_objects
from roverkit.vision.ros.camera_info import camera_info_topic
from roverkit.vision.ros.image_messages import compressed_of
from roverkit.vision.ros.object_messages import detections_2d_of, detections_3d_of
from roverkit.vision.ros.outputs import Outputs
from roverlink.console import OK, NoProjectError
from roverlink.node_log import publish_log
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.ros_arguments.ros_args import RosArguments

_RUNS, _RUN = 9000, 1000
"""Number of runs with different numbers of objects, and the step from one to the next."""


@dataclass(frozen=True, slots=True, eq=False)
class ObjectResult:
    """Frame with the objects in it, and those of their positions that are known, by the objects' numbers."""

    frame: Frame
    objects: list[TrackedObject]
    locations: Mapping[int, Location]

    def as_dict(self) -> dict[str, Any]:
        """Return the results as JSON values: pixels and metres."""
        frame = self.frame
        return {
            "stamp": frame.stamp,
            "frame": frame.number,
            "frame_id": frame.frame_id,
            "objects": [self._object(tracked) for tracked in self.objects],
        }

    def _object(self, tracked: TrackedObject) -> dict[str, Any]:
        found = {"id": tracked.id, **as_json(tracked)}
        if location := self.locations.get(tracked.id):
            found["position"] = [rounded(value) for value in location.point.tolist()]
            found["covariance"] = [rounded(value) for value in location.covariance.ravel().tolist()]
        return found


Output = Callable[[ObjectResult], None]


def track(arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger) -> int:
    """Track objects until the source of frames ends, and return the exit code.

    Raises `SetupError` if a file, the source of frames or a package is missing, or if a file is wrong.
    """
    with ExitStack() as stack:
        detector, classes = open_detector(arguments, arguments.score)
        logger.info("%s: layout %s, run by %s", detector.name, detector.layout, detector.provider)
        connection = RosConnection(ros, arguments.middleware or "auto", stack, logger.warning)
        text = source_of(arguments, logger.warning)
        source = stack.enter_context(open_source(text, settings_of(arguments), connection, say=logger.warning))
        depth = _depth(source, arguments, connection, logger, stack)
        outputs = [*_film(source, text, arguments, stack)]
        if arguments.middleware:
            stack.enter_context(publish_log(logger, connection.middleware, ros))
            outputs += _publishers(arguments, classes, detector.class_names, connection, logger)
        log = stack.enter_context(ObjectLog(logger, connection.clock))
        certain = detector.certain if arguments.certain is None else arguments.certain
        tracker = ObjectTracker(_first_number() if arguments.middleware else 1, certain)
        for frame in with_progress(_frames(source, arguments, connection), [source], arguments):
            objects = tracker.track(detector.detect(frame.image), frame.stamp)
            result = ObjectResult(frame, objects, _locations(objects, frame, depth))
            if arguments.json:
                print(json.dumps(result.as_dict()), flush=True)
            for output in outputs:
                output(result)
            log.add(frame, objects, live=source.live)
        if isinstance(source, ImageFiles) and not log.seen:
            logger.info("single photographs, which no object joins, are for `roverlink objects detect`")
    return OK


def _first_number() -> int:
    """Return the number of the first object of a run that others hear: 1000001, 1001001 and so on to 9999001.

    It is random: a selection of an earlier run must not name an object of this one.
    """
    return (_RUN + secrets.randbelow(_RUNS)) * _RUN + 1


def _frames(source: FrameSource, arguments: argparse.Namespace, ros: RosConnection) -> Iterator[Frame]:
    """Yield the frames of a source with the name of the camera's frame, at most ``--count``.

    The frames of a recording come at full speed. But they come in real time if they are also published or repeated.
    """
    played = not source.live and (arguments.middleware or arguments.loop)
    frames = play(source, loop=arguments.loop, clock=ros.clock) if played else iter(source)
    for frame in itertools.islice(frames, arguments.count):
        yield replace(frame, frame_id=arguments.camera_frame or frame.frame_id or CAMERA_FRAME)


def _depth(
    source: FrameSource, arguments: argparse.Namespace, ros: RosConnection, logger: logging.Logger, stack: ExitStack
) -> DepthCamera | None:
    """Return the camera's depth, which is received from now on; None if it is not known to have one.

    Nobody is told that depth is missing if nobody has asked for it.
    """
    wanted = arguments.depth or arguments.camera_info
    if not isinstance(source, TopicSource):
        if wanted:
            raise SetupError("--depth and --camera-info have no effect, because the source is not topic:NAME")
        return None
    try:
        depth = full_topic(arguments.depth, ros.arguments) if arguments.depth else aligned_depth_topic(source.name)
    except SetupError:
        if wanted:
            raise
        return None
    info = arguments.camera_info
    topics = CameraTopics(
        source.name, depth, full_topic(info, ros.arguments) if info else camera_info_topic(source.name)
    )
    camera = DepthCamera(ros, lambda: topics, logger.warning if wanted else lambda _: None)
    stack.enter_context(camera.in_background())
    return camera


def _locations(objects: list[TrackedObject], frame: Frame, depth: DepthCamera | None) -> dict[int, Location]:
    if depth is None or not objects:
        return {}
    try:
        image = depth.image(frame.stamp)
    except NoDepthError:  # the depth camera has said it
        return {}
    found = {tracked.id: locate(tracked.box, image.depth, image.camera) for tracked in objects}
    return {number: location for number, location in found.items() if location}


def _film(source: FrameSource, text: str, arguments: argparse.Namespace, stack: ExitStack) -> Iterator[Output]:
    if arguments.save:
        film = stack.enter_context(Film(arguments.save, source.rate, text))
        yield lambda result: film.add(_drawn(result), result.frame.stamp)


def _publishers(
    arguments: argparse.Namespace,
    classes: ClassesFile,
    names: tuple[str, ...],
    ros: RosConnection,
    logger: logging.Logger,
) -> Iterator[Output]:
    """Yield outputs that publish the objects, and that send them to the basestation."""
    outputs = Outputs(ros.middleware, ros.topic, logger.warning)
    flat = outputs.open(DETECTIONS)
    solid = outputs.open(DETECTIONS_3D)
    image = outputs.open(IMAGE)

    def publish(result: ObjectResult) -> None:
        stamp, frame = result.frame.stamp, result.frame.frame_id
        flat.put(lambda: detections_2d_of(result.objects, stamp, frame))
        solid.put(lambda: detections_3d_of(result.objects, result.locations, stamp, frame))
        image.put(lambda: compressed_of(_drawn(result), stamp, frame))

    yield publish
    try:
        row = DetectedObjectRow(project_registry(arguments))
    except NoProjectError as error:  # detection works without a bridge
        logger.warning("the objects are not sent to the basestation: %s", error)
        return
    publisher = row.topic.publisher(ros.middleware, ros.topic)
    types = ObjectTypes(classes, row.types, names, logger.warning)

    def send(result: ObjectResult) -> None:
        objects = [(tracked, types.of(tracked.class_name)) for tracked in result.objects]
        publisher.publish(list(row.messages(objects, result.frame.size)))

    yield send


def _drawn(result: ObjectResult) -> Any:
    return draw_objects(result.frame.image, result.objects, result.locations)
