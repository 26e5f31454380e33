"""Implementation of ``roverlink mission run``: drives to the goals of a file, and reports the progress."""

from __future__ import annotations

import roverkit.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

import argparse
import logging
import math
import time
from collections.abc import Callable
from dataclasses import replace

from roverkit.driving.drive_rows import DriveRows
from roverkit.mission.mission_declaration import STATE
from roverkit.mission.mission_file import read_mission
from roverkit.mission.mission_row import progress_publisher
from roverkit.mission.mission_rules import MissionRun, Report, State
from roverkit.node.program import connected, json_printer, project_registry
from roverkit.vision.ros.outputs import Output, Outputs
from roverlink.runtime.interfaces import std_msgs
from roverlink.runtime.ros_arguments.ros_args import RosArguments

_DISTANCE_S = 1.0  # time in seconds between two reports of the distance
_LOGGED_S = 5.0  # time in seconds between two such reports in the log


def run_mission(arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger) -> bool:
    """Drive to the goals of a mission. Returns true if all have been reached.

    Raises `SetupError` if the file has a mistake, or if Nav2 or the rover's pose is missing.
    """
    mission = read_mission(arguments.mission)
    registry = project_registry(arguments)
    rows = DriveRows(registry)
    with connected(ros, "rclpy", logger) as connection:
        middleware = connection.middleware
        from roverkit.mission.nav2_rover import Nav2Rover  # only here: it imports rclpy, which may be missing

        output = Outputs(middleware, connection.topic, logger.warning).open(STATE)
        publish = progress_publisher(middleware, registry, connection.topic, len(mission.goals))
        reporting = Reporting(logger, output, publish, len(mission.goals), as_json=arguments.json)
        rover = Nav2Rover(connection, mission, rows, arguments.base_frame, reporting.show_distance, logger.warning)
        try:
            rover.wait_until_ready(arguments.wait)
            reporting.take(Report(State.WAITING, 0, "waiting until the operator hands over the rover (MODE_AUTO)"))
            rover.wait_for_handover()
            return MissionRun(mission, rover, reporting.take).run()
        except KeyboardInterrupt:
            reporting.stop("this program was interrupted")
            raise


class Reporting:
    """News of a mission: in the log, on topics and, if wanted, as JSON on standard output."""

    def __init__(
        self,
        logger: logging.Logger,
        output: Output,
        publish: Callable[[Report], None],
        goals: int,
        *,
        as_json: bool,
    ) -> None:
        self._logger, self._output, self._publish, self._goals = logger, output, publish, goals
        self._print = json_printer(as_json)
        self._last = Report(State.WAITING)
        self._shown = self._logged = -math.inf

    def take(self, report: Report) -> None:
        """Report news."""
        self._last = report
        bad = report.state in (State.FAILED, State.STOPPED)
        self._logger.log(logging.WARNING if bad else logging.INFO, "%s", report.message)
        self._output.publish(
            std_msgs.String(f"{report.state.value} {report.goal}" if report.goal else report.state.value)
        )
        self._tell(report)

    def stop(self, message: str) -> None:
        """Report that the mission ends before its last goal."""
        self.take(Report(State.STOPPED, self._last.goal, message))

    def show_distance(self, distance: float) -> None:
        """Report the metres that are left to the place to which the rover drives."""
        now = time.monotonic()
        if now - self._shown < _DISTANCE_S:
            return
        self._shown = now
        self._tell(replace(self._last, distance=distance))
        if now - self._logged >= _LOGGED_S:
            self._logged = now
            self._logger.info("%.1f m left", distance)

    def _tell(self, report: Report) -> None:
        self._publish(report)
        distance = report.distance if math.isfinite(report.distance) else None
        entry = {"state": report.state.value, "goal": report.goal, "goals": self._goals, "distance": distance}
        self._print({**entry, "message": report.message})
