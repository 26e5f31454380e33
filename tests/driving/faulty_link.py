"""A simulated rover and its odometry, between which commands and reports are delayed, lost, repeated and reordered."""

from __future__ import annotations

import heapq
import random
from dataclasses import dataclass
from typing import TypeVar

from roverlink.driving.board_commands import BoardCommand
from roverlink.driving.rover_model import STEP_NS, MotorReport, ProgressReport, RoverModel, RoverSettings
from roverlink.driving.rover_sensors import ImuReading, ImuSettings
from roverlink.driving.wheel_odometry import OdometryEstimate, WheelOdometry

IDEAL = RoverSettings(
    slip=0.0,
    side_slip=0.0,
    yaw_slip=0.0,
    imu=ImuSettings(gyro_noise=0.0, gyro_bias=0.0, gyro_bias_walk=0.0),
    gps_period=10**12,
)
"""A rover of which the odometry may know everything: no slip, and a gyroscope without errors."""


_SENT_NS = STEP_NS - 500_000
"""Time in a step of the model at which commands are sent: half a millisecond before the board can receive them."""

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Faults:
    """Probabilities of faults of a link, and times in seconds."""

    lost: float = 0.0
    repeated: float = 0.0
    late: float = 0.0
    """Probability that a report is `lateness` later, so that newer ones overtake it."""
    lateness: float = 0.12
    delay: float = 0.0005
    """Usual longest delay."""
    motors: bool = True
    imu: bool = True


class FaultyLink:
    """A rover whose boards and whose odometry have only a faulty link."""

    def __init__(self, seed: int, faults: Faults, settings: RoverSettings = IDEAL) -> None:
        self.model, self.odometry, self.faults = RoverModel(seed, settings), WheelOdometry(), faults
        self.rng = random.Random(seed)  # noqa: S311  # repeatable, not secret
        self.estimates: list[OdometryEstimate] = []
        self._commands: list[tuple[int, int, BoardCommand]] = []
        self._reports: list[tuple[int, int, ProgressReport | MotorReport | ImuReading]] = []
        self._count = 0

    def command(self, command: BoardCommand) -> None:
        """Send a command, as it is seen on the topic now; it arrives at the board somewhat later, or never."""
        board, now = self.model.settings.board, self.model.now + _SENT_NS
        self.odometry.command(now, board.drivable(board.arc(command)))
        if self.rng.random() >= self.faults.lost:
            self._put(self._commands, now, command)

    def run(self, seconds: float) -> None:
        """Let time pass."""
        end = self.model.now + round(seconds * 1e9)
        while self.model.now < end:
            while self._commands and self._commands[0][0] <= self.model.now:
                self.model.command(heapq.heappop(self._commands)[2])
            for one in self.model.advance(STEP_NS / 1e9):
                if isinstance(one, (ProgressReport, MotorReport)):
                    self._transport(one)
                elif isinstance(one, ImuReading) and self.faults.imu:
                    self._put(self._reports, one.at, one)
            while self._reports and self._reports[0][0] < self.model.now + _SENT_NS:
                self._deliver(*heapq.heappop(self._reports)[::2])

    def error(self) -> tuple[float, float, float]:
        """The last estimate minus the truth, in the frame of the start: x, y in metres and yaw in radians."""
        pose, truth = self.estimates[-1].pose, self.model.pose
        return pose.x - truth.x, pose.y - truth.y, pose.yaw - truth.yaw

    def _transport(self, report: ProgressReport | MotorReport) -> None:
        if self.rng.random() < self.faults.lost:
            return
        for _ in range(2 if self.rng.random() < self.faults.repeated else 1):
            late = self.faults.lateness if self.rng.random() < self.faults.late else 0.0
            self._put(self._reports, report.at + round(late * 1e9), report)

    def _put(self, queue: list[tuple[int, int, T]], at: int, what: T) -> None:
        self._count += 1
        heapq.heappush(queue, (at + round(self.rng.uniform(0, self.faults.delay) * 1e9), self._count, what))

    def _deliver(self, at: int, report: ProgressReport | MotorReport | ImuReading) -> None:
        if isinstance(report, ImuReading):
            self.odometry.angular_velocity(at, report.angular_velocity[2])
        elif isinstance(report, MotorReport):
            if self.faults.motors:
                self.odometry.motors(at, (abs(report.left_rpm) + abs(report.right_rpm)) / 2)
        elif estimate := self.odometry.progress(at, report.distance_left):
            self.estimates.append(estimate)
