"""Implementation of ``roverlink objects select``: publishes the position of the object that the operator selects."""

from __future__ import annotations

import roverkit.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

import argparse
import logging
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from queue import Empty, Queue

from roverkit.node.program import connected, json_printer, project_registry
from roverkit.node.ros_connection import RosConnection
from roverkit.objects.location import Location
from roverkit.objects.object_declarations import (
    LOCATED,
    MAP_POSE,
    MAP_POSE_WITH_COVARIANCE,
    POSE,
    POSE_WITH_COVARIANCE,
    STATE,
)
from roverkit.objects.object_rows import ObjectSelectionRow
from roverkit.objects.selection import Scene, Selection, State
from roverkit.vision.poses.pose import Pose
from roverkit.vision.poses.transform_tree import TransformError
from roverkit.vision.ros.object_messages import locations_of, pose_of
from roverkit.vision.ros.outputs import Output, Outputs
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.interfaces import geometry_msgs, std_msgs, vision_msgs
from roverlink.runtime.ros_arguments.ros_args import RosArguments
from roverlink.runtime.ros_time.headers import header_of, stamp_of

_PERIOD_S = 0.1
"""Time in seconds between two messages about an object that is hidden."""
REFUSED = "refused"
"""State of a selection of an object that is not known."""

Event = Callable[[], None]


def select_objects(arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger) -> None:
    """Publish positions until the program is stopped. Raises `SetupError` if the table lacks the row."""
    row = ObjectSelectionRow(project_registry(arguments))
    with connected(ros, arguments.middleware, logger) as connection:
        selector = Selector(connection, arguments, logger)
        events: Queue[Event] = Queue()

        def take_selections(messages: Sequence[bytes]) -> None:
            for data in messages:
                try:
                    number = row.number(data)
                except ConversionError as error:
                    logger.warning("ignoring a selection that cannot be read: %s", error)
                    continue
                events.put(partial(selector.select, number))

        def take_detections(messages: Sequence[bytes]) -> None:
            try:
                found = cdr.decode(vision_msgs.Detection3DArray, messages[-1])
            except ConversionError as error:
                logger.warning("ignoring detections that cannot be read: %s", error)
                return
            events.put(partial(selector.see, found))

        LOCATED.subscribe(connection.middleware, ros.topic, take_detections)
        row.topic.subscribe(connection.middleware, ros.topic, take_selections)
        logger.info(
            "waiting for selections on %s, with the objects of %s", ros.topic(row.topic.name), ros.topic(LOCATED.name)
        )
        while True:
            with suppress(Empty):
                events.get(timeout=_PERIOD_S)()
            selector.hold()


class Selector:
    """Publishes the position and the state of the selected object."""

    def __init__(self, connection: RosConnection, arguments: argparse.Namespace, logger: logging.Logger) -> None:
        self._tree, self._clock, self._logger = connection.transforms, connection.clock, logger
        self._base, self._map = arguments.base_frame, arguments.map_frame
        self._print = json_printer(arguments.json)
        self._selection = Selection(round(arguments.hold * 1e9))
        self._said: tuple[State, int | None] | None = (State.NONE, None)
        self._published = 0
        self._unknown: set[str] = set()
        outputs = Outputs(connection.middleware, connection.topic, logger.warning)
        self._state = outputs.open(STATE)
        self._in_base = outputs.open(POSE), outputs.open(POSE_WITH_COVARIANCE)
        self._in_map = outputs.open(MAP_POSE), outputs.open(MAP_POSE_WITH_COVARIANCE)

    def see(self, message: vision_msgs.Detection3DArray) -> None:
        """Take the objects of an image, and publish the position of the selected one."""
        stamp, camera = stamp_of(message.header), message.header.frame_id
        scene = Scene(
            locations_of(message), self._transform(self._base, camera, stamp), self._transform(self._map, camera, stamp)
        )
        now = self._clock.now()
        if self._selection.see(scene, now):
            self._publish(stamp, now)

    def select(self, number: int) -> None:
        """Select an object by its number; 0 ends the selection."""
        now = self._clock.now()
        if number == 0:
            self._selection.clear()
        elif self._selection.select(number, now):
            self._publish(now, now)
        else:
            known = ", ".join(map(str, self._selection.known(now))) or "none"
            self._logger.warning("object %d is not selected, because no camera sees it (visible: %s)", number, known)
            self._say(REFUSED, number)
            self._said = None  # then the state that remains is reported

    def hold(self) -> None:
        """Publish the position of the selected object if it is hidden, and its state if that has changed."""
        now = self._clock.now()
        self._selection.update(now)
        if self._selection.state is State.HELD and now - self._published >= _PERIOD_S * 1e9:
            self._publish(now, now)
        self._report()

    def _publish(self, stamp: int, now: int) -> None:
        """Publish the position; ``stamp`` is that of the image or, while the object is hidden, ``now``."""
        self._published = now
        place = self._selection.place(now, self._transform(self._base, self._map, stamp))
        for location, frame, outputs in (
            (place.in_base, self._base, self._in_base),
            (place.in_map, self._map, self._in_map),
        ):
            if location:
                _put(outputs, location, frame, stamp)

    def _transform(self, target: str, source: str, stamp: int) -> Pose | None:
        try:
            return self._tree.look_up(target, source, stamp)
        except TransformError as error:
            if target not in self._unknown:  # once, because it may be normal: not every rover has a map
                self._unknown.add(target)
                self._logger.info("positions in %r are not published yet: %s", target, error)
            return None

    def _report(self) -> None:
        """Report the state if it has changed."""
        state = self._selection.state
        number = None if state is State.NONE else self._selection.object
        if self._said == (state, number):
            return
        self._said = (state, number)
        self._logger.info("no object is selected" if number is None else f"object {number}: {state.value}")
        self._say(state.value, number)

    def _say(self, state: str, number: int | None) -> None:
        text = state if number is None else f"{state} {number}"
        self._state.publish(std_msgs.String(text))
        self._print({"state": state, "id": number})


def _put(outputs: tuple[Output, Output], location: Location, frame: str, stamp: int) -> None:
    header, pose = header_of(stamp, frame), pose_of(location)
    plain, uncertain = outputs
    plain.put(lambda: geometry_msgs.PoseStamped(header, pose.pose))
    uncertain.put(lambda: geometry_msgs.PoseWithCovarianceStamped(header, pose))
