"""Implementation of ``roverlink odometry``: the rover's pose and velocity, from the driving board and an IMU."""

from __future__ import annotations

import argparse
import logging
import threading
from collections.abc import Callable, Sequence
from functools import partial

from roverkit.gating import Reasons
from roverkit.node.program import connected, json_printer, project_registry
from roverkit.node.reason_diagnostics import ReasonDiagnostics
from roverkit.node.ros_connection import RosConnection
from roverkit.odometry.odometry_declaration import IMU, ODOMETRY, TRANSFORM
from roverkit.odometry.odometry_messages import odometry_of, transform_of
from roverkit.odometry.odometry_parameters import OdometryParameters
from roverkit.odometry.odometry_rows import OdometryRows
from roverkit.odometry.tape_test import TapeTest
from roverkit.odometry.wheel_odometry import OdometryEstimate, WheelOdometry
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.interfaces.sensor_msgs import Imu
from roverlink.runtime.interfaces.tf2_msgs import TFMessage
from roverlink.runtime.ros_arguments.ros_args import RosArguments
from roverlink.runtime.ros_time.clock import SYSTEM_CLOCK
from roverlink.runtime.ros_time.headers import header_of, stamp_of

_PERIOD_S = 0.1
_FASTEST_TURN = 100.0
"""Angular velocity in rad/s that no gyroscope of a rover measures; most end at 35 rad/s (2000 degrees/s)."""
_SILENCE_S = 0.5
"""Time without a report of the driving board after which the last estimate is repeated."""


def publish_odometry(arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger) -> None:
    """Publish until the program is stopped.

    Raises `SetupError` if the table lacks a row, or if a parameter is wrong.
    """
    rows = OdometryRows(project_registry(arguments))
    parameters = OdometryParameters(ros, logger)
    with connected(ros, arguments.middleware, logger, parameters) as connection:
        node = OdometryNode(connection, rows, parameters, logger, as_json=arguments.json, tape=arguments.tape)
        node.receive()
        logger.info(
            "waiting for reports on %s; odometry on %s", ros.topic(rows.progress.name), ros.topic(ODOMETRY.name)
        )
        node.run()


class OdometryNode:
    """Node that computes odometry; its topics are received on threads of the middleware."""

    def __init__(
        self,
        connection: RosConnection,
        rows: OdometryRows,
        parameters: OdometryParameters,
        logger: logging.Logger,
        *,
        as_json: bool,
        tape: float | None = None,
    ) -> None:
        """``tape`` is the length in metres of a tape along which the rover drives, if it does."""
        self._connection, self._rows, self._parameters, self._logger = connection, rows, parameters, logger
        self._print = json_printer(as_json)
        self._clock = connection.clock
        self.reasons = Reasons(logger.warning)
        """Reasons why inputs are left out, and why something is not known."""
        self._diagnostics = ReasonDiagnostics(connection, self.reasons)
        self._odometry = WheelOdometry(parameters.meaning.noise, self.reasons, has_odometer=rows.has_odometer)
        # In memory, a subscriber of the odometry may send a command, which comes back at once.
        self._lock = threading.RLock()
        self._reported_at: int | None = None
        self._is_silent = False
        self._tape = tape and TapeTest(tape, lambda: parameters.meaning.distance_scale, partial(logger.info, "%s"))
        middleware, topic = connection.middleware, connection.topic
        self._publisher = ODOMETRY.publisher(middleware, topic)
        self._transforms = TRANSFORM.publisher(middleware, topic)

    def receive(self) -> None:
        """Begin to receive the topics."""
        middleware, topic = self._connection.middleware, self._connection.topic
        for row, take in (
            (self._rows.command, self._take_command),
            (self._rows.progress, self._take_progress),
            (self._rows.diagnostics, self._take_diagnostics),
        ):
            row.subscribe(middleware, topic, self._each(take))
        IMU.subscribe(middleware, topic, self._each(self._take_imu))

    def run(self) -> None:
        """Repeat the last estimate while the driving board reports nothing, until a signal interrupts this."""
        while True:
            now = self._clock.now()
            self._clock.sleep_until(now + round(_PERIOD_S * 1e9), now)
            self.tick()

    def tick(self) -> None:
        """Publish the reasons, and the last estimate again if the driving board has reported nothing for a while."""
        with self._lock:
            now = self._clock.now()
            self._diagnostics.publish(now)
            if self._reported_at is None:
                topic = self._connection.topic(self._rows.progress.name)
                self.reasons.lack("odometry", f"no report of the driving board comes on {topic}", now)
            if self._reported_at is None or now - self._reported_at < _SILENCE_S * 1e9:
                return
            if not self._is_silent:
                self._is_silent = True
                self._logger.warning("the driving board reports nothing; the position becomes uncertain")
            if (estimate := self._odometry.silent(now)) is not None:
                self._publish(estimate)

    def _each(self, take: Callable[[bytes], None]) -> Callable[[Sequence[bytes]], None]:
        """Return a callback that takes messages one by one, and reports those that cannot be used."""

        def take_all(messages: Sequence[bytes]) -> None:
            with self._lock:
                for data in messages:
                    try:
                        take(data)
                    except ConversionError as error:
                        self.reasons.tell(f"ignoring a message: {error}")

        return take_all

    def _take_command(self, data: bytes) -> None:
        board, command = self._parameters.meaning.board, self._rows.board_command(data)
        try:
            arc = board.arc(command)
        except ValueError as error:  # somebody commands what is no number; the board stops then
            raise ConversionError(str(error)) from error
        self._odometry.command(self._clock.now(), board.drivable(arc), command.command_number)

    def _take_diagnostics(self, data: bytes) -> None:
        if (rpm := self._rows.rpm(data)) is not None:
            self._odometry.motors(self._clock.now(), rpm)

    def _take_imu(self, data: bytes) -> None:
        message = cdr.decode(Imu, data)
        rate = message.angular_velocity.z
        if not abs(rate) < _FASTEST_TURN:
            raise ConversionError(f"the angular velocity of an IMU is {rate}")
        # A bridge stamps with the time of the computer, which is not that of a simulation.
        real = self._clock is SYSTEM_CLOCK and (message.header.stamp.sec or message.header.stamp.nanosec)
        self._odometry.angular_velocity(stamp_of(message.header) if real else self._clock.now(), rate)

    def _take_progress(self, data: bytes) -> None:
        report, now = self._rows.report(data), self._clock.now()
        settings = self._parameters.meaning
        self._odometry.noise, self._odometry.distance_scale = settings.noise, settings.distance_scale
        self._reported_at, self._is_silent = now, False
        self.reasons.give("odometry")
        if (estimate := self._odometry.progress(now, *report)) is None:
            return
        if self._tape:
            self._tape.take(estimate)
        self._publish(estimate)

    def _publish(self, estimate: OdometryEstimate) -> None:
        settings = self._parameters.meaning
        message = odometry_of(estimate, header_of(estimate.at, settings.odom_frame), settings.base_frame)
        self._publisher.publish([cdr.encode(message)])
        if settings.publish_tf:
            self._transforms.publish([cdr.encode(TFMessage([transform_of(message)]))])
        pose, speed, rate = estimate.pose, estimate.speed, estimate.yaw_rate
        entry = {"stamp": estimate.at, "x": pose.x, "y": pose.y, "yaw": pose.yaw, "speed": speed, "yaw_rate": rate}
        self._print({**entry, "covariance": estimate.covariance})
