"""Implementation of ``roverlink drive``: velocities and paths become commands for the driving board."""

from __future__ import annotations

import argparse
import logging
import math
import threading
from collections.abc import Callable, Sequence
from contextlib import closing
from functools import partial

from roverkit.driving.acknowledgement import Acknowledgement
from roverkit.driving.board_commands import BoardCommand
from roverkit.driving.drive_control import DriveControl, Localization, State, Status
from roverkit.driving.drive_declaration import PATH, POSE, STATE, VELOCITY
from roverkit.driving.drive_inputs import path_of, pose_of, velocity_of
from roverkit.driving.drive_parameters import DriveParameters
from roverkit.driving.drive_rows import DriveRows
from roverkit.node.program import connected, json_printer, project_registry
from roverkit.node.ros_connection import RosConnection
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError, MiddlewareError
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces.std_msgs import String
from roverlink.runtime.ros_arguments.ros_args import RosArguments
from roverlink.runtime.ros_time.clock import MONOTONIC_CLOCK, SYSTEM_CLOCK

_MODE_PRIORITY = 9
"""The mode is served before velocities, so that a flood of them does not keep a person from driving."""

_LONGEST_TICK_S = 0.05
"""Time after which it is looked again at what is due, such as a stop because a topic is silent."""

Event = Callable[[int], None]
"""Something that has happened, with the time in nanoseconds at which the control takes it."""


def drive(arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger) -> None:
    """Drive until the program is stopped; then the rover stops.

    Raises `SetupError` if the table lacks a row, or if a parameter is wrong.
    """
    rows = DriveRows(project_registry(arguments))
    parameters = DriveParameters(ros, logger)
    with connected(ros, arguments.middleware, logger, parameters) as connection:
        driving = Driving(connection, rows, parameters, logger, as_json=arguments.json)
        with closing(driving):
            driving.receive()
            topics = (ros.topic(topic.name) for topic in (VELOCITY, PATH, rows.mode))
            logger.info("driving as %s and %s say, while %s is AUTO", *topics)
            driving.run()


class Driving:
    """Node that drives: its topics, and the times at which commands are sent."""

    def __init__(
        self,
        connection: RosConnection,
        rows: DriveRows,
        parameters: DriveParameters,
        logger: logging.Logger,
        *,
        as_json: bool,
    ) -> None:
        self._connection, self._rows, self._parameters, self._logger = connection, rows, parameters, logger
        self._print = json_printer(as_json)
        self._control = DriveControl(lambda: parameters.meaning.control, logger.warning)
        self._stamps = connection.clock
        # Timeouts must not depend on somebody setting the time of the computer.
        self._clock = MONOTONIC_CLOCK if self._stamps is SYSTEM_CLOCK else self._stamps
        # Held while a command is sent, so that none follows the stop that a change of the mode causes.
        self._lock = threading.RLock()
        self._reported: Status | None = None
        self._ended = False
        middleware, topic = connection.middleware, connection.topic
        self._followed = VELOCITY.follow(middleware, topic, self._take_velocity, depth=1)
        self._commands = rows.command.publisher(middleware, topic)
        self._acknowledgement = Acknowledgement()
        self._states = STATE.publisher(middleware, topic)

    def receive(self) -> None:
        """Begin to receive the topics."""
        middleware, topic = self._connection.middleware, self._connection.topic
        self._rows.mode.subscribe(middleware, topic, self._take_mode, _MODE_PRIORITY)
        PATH.subscribe(middleware, topic, self._take_path)
        POSE.subscribe(middleware, topic, self._take_pose)
        if self._rows.report is not None:
            self._rows.report.subscribe(middleware, topic, self._take_report)
        self.tick()  # report the first state

    def run(self) -> None:
        """Send what is due, again and again, until a signal interrupts this."""
        while True:
            now, period = self._clock.now(), self._parameters.meaning.control.period
            ticks = math.ceil(period / _LONGEST_TICK_S)  # a whole number, so that commands have their rate
            self._clock.sleep_until(now + math.ceil(period * 1e9 / ticks), now)
            self.tick()

    def tick(self) -> None:
        """Send what is due, and receive velocities of the type that is published now."""
        try:
            self._followed.look()
        except MiddlewareError as error:
            self._tell(f"no velocities are received: {error}")
        self._happen(lambda _: None)

    def close(self) -> None:
        """Stop the rover if it moves, and send nothing any more."""
        with self._lock:
            self._ended = True
            now = self._clock.now()
            self._control.set_mode(False, now)
            if command := self._control.step(now):
                self._send(command)
            self._report(Status(State.MANUAL, "this program ends"))

    def _happen(self, event: Event) -> None:
        """Let the control take an event and decide, and send what it decides."""
        with self._lock:
            if self._ended:
                return
            now = self._clock.now()  # with the lock, so that the control's time goes forwards
            event(now)
            command = self._control.step(now)
            if command is not None:
                self._send(command)
            self._report(self._control.status)

    def _take_mode(self, messages: Sequence[bytes]) -> None:
        for data in messages:  # each of them: a short MANUAL ends the path
            try:
                automatic = self._rows.is_automatic(data)
            except ConversionError as error:
                self._tell(f"ignoring a control_mode: {error}")
                continue
            self._happen(partial(self._control.set_mode, automatic))

    def _take_velocity(self, kind: type[Message], messages: Sequence[bytes]) -> None:
        settings = self._parameters.meaning
        try:
            linear, angular = velocity_of(
                kind, messages[-1], self._stamps.now(), settings.control.timeout, settings.base_frame
            )
        except ConversionError as error:
            self._tell(f"ignoring a velocity: {error}")
            return
        self._happen(lambda now: self._control.drive(linear, angular, now))

    def _take_path(self, messages: Sequence[bytes]) -> None:
        try:
            points, frame = path_of(messages[-1], self._stamps.now())
        except ConversionError as error:
            self._tell(f"ignoring a path: {error}")
            return
        self._happen(lambda now: self._control.follow(points, frame, now))

    def _take_pose(self, messages: Sequence[bytes]) -> None:
        settings = self._parameters.meaning
        try:
            place = pose_of(messages[-1], self._stamps.now(), settings.control.pose_timeout, settings.base_frame)
        except ConversionError as error:
            self._tell(f"ignoring a pose: {error}")
            return
        with self._lock:  # the next command is sent when it is due: poses come more often
            now = self._clock.now()
            localization = Localization(place.pose, place.frame, now - place.age, place.deviation, place.speed)
            self._control.localize(localization, now)

    def _take_report(self, messages: Sequence[bytes]) -> None:
        try:
            number = self._rows.number(messages[-1])
        except ConversionError as error:
            self._tell(f"ignoring a report: {error}")
            return
        with self._lock:
            stop = None if self._ended else self._acknowledgement.lost_stop(number, self._clock.now())
            if stop is not None:
                self._tell("the driving board has not taken the stop; it is sent again")
                self._publish(stop)

    def _tell(self, message: str) -> None:
        with self._lock:
            self._control.tell(message, self._clock.now())

    def _send(self, command: BoardCommand) -> None:
        self._publish(self._acknowledgement.numbered(command, self._clock.now()))

    def _publish(self, command: BoardCommand) -> None:
        self._commands.publish([self._rows.serialized(command)])
        self._print({"stamp": self._stamps.now(), **self._rows.values(command)})

    def _report(self, status: Status) -> None:
        """Report the state if it has changed."""
        if status == self._reported:
            return
        self._reported = status
        text = ": ".join(filter(None, (status.state.value, status.reason)))
        self._states.publish([cdr.encode(String(text))])
        self._logger.info("%s", text)
        self._print({"stamp": self._stamps.now(), "state": status.state.value, "reason": status.reason})
