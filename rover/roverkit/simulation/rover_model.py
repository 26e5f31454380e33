"""Model of a rover: its driving board executes commands, its wheels slip, and its boards measure.

The model is deterministic. The same settings, seed and commands at the same times give the same measurements,
independent of the lengths of the steps in which the time advances. It needs no socket, no ROS 2 and no clock.

Slip is a first-order Gauss-Markov process over the distance that the wheels roll. Over distances far longer than its
correlation length L, the error of the distance is a random walk: its variance grows by 2 s^2 L with each metre, where s
is the standard deviation of the slip. The error of the yaw follows the same formula. L is 0.5 m, so that the standard
deviation after one metre is that of the slip itself.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, field
from enum import IntEnum

from roverkit.driving.arcs import Arc, PlanarPose
from roverkit.driving.board_commands import BoardCommand, DrivingBoard
from roverkit.simulation.rover_sensors import GpsFix, GpsReceiver, GpsSettings, Imu, ImuReading, ImuSettings, Motion

STEP_NS = 10_000_000
"""Length of the model's time step in nanoseconds. The periods of the measurements are multiples of it."""
_STEP_S = STEP_NS / 1e9
SLIP_LENGTH_M = 0.5
"""Correlation length of the slip in metres."""


@dataclass(frozen=True, slots=True)
class RoverSettings:
    """Settings of a model. Periods are in nanoseconds."""

    board: DrivingBoard = field(default_factory=lambda: DrivingBoard(smallest_radius=0.5))
    speed: float = 0.5
    """Speed in m/s at which the board drives a long arc."""
    acceleration: float = 0.5
    """Acceleration of the board, and its deceleration before the end of an arc, in m/s^2."""
    braking: float = 2.0
    """Deceleration in m/s^2 after a stop, and before the rover reverses."""
    steering_rate: float = 2.0
    """Rate at which the board changes the curvature, in 1/m per second."""
    slip: float = 0.05
    """Standard deviation of the wheels' slip: the part of the rolled distance that the rover does not move."""
    mean_slip: float = 0.02
    """Standard deviation of the mean of the slip, which stays the same."""
    side_slip: float = 0.01
    """Standard deviation of the sideways motion, as a part of the rolled distance."""
    yaw_slip: float = 0.03
    """Standard deviation of the curvature that slip adds to the arc, in 1/m."""
    wheel_radius: float = 0.1
    """Radius of the wheels in metres."""
    track: float = 0.6
    """Distance in metres between the wheels on the left and those on the right."""
    wheelbase: float = 0.8
    """Distance in metres between the front and the back axle."""
    restart_time: float = 1.0
    """Time in seconds that the driving board takes to restart."""
    progress_period: int = 50_000_000
    motors_period: int = 100_000_000
    imu_period: int = 20_000_000
    gps_period: int = 200_000_000
    imu: ImuSettings = field(default_factory=ImuSettings)
    gps: GpsSettings = field(default_factory=GpsSettings)


class BoardState(IntEnum):
    """State of the driving board and of its motors; the numbers are those of ``DrivingBoardDiagnostics.State``."""

    IDLE = 0
    OPERATING = 1


@dataclass(frozen=True, slots=True)
class ProgressReport:
    """Measurement of the driving board: the message ``drive_progress``."""

    at: int
    """Time in nanoseconds since the start of the model."""
    distance_left: float
    """Distance left on the current command in metres, negative for driving backwards."""
    odometer: float = 0.0
    """Signed distance in metres that the wheels have rolled since the start of the board."""
    command_number: int = 0
    """Number of the newest command that the board has taken since its start."""


@dataclass(frozen=True, slots=True)
class MotorReport:
    """Measurement of the driving board: the content of the message ``drive_diag``."""

    at: int
    """Time in nanoseconds since the start of the model."""
    state: BoardState
    left_rpm: float
    """Speed of the three wheels on the left, in revolutions per minute; positive is forwards."""
    right_rpm: float
    """Speed of the three wheels on the right."""
    steering: float
    """Angle of the front wheels in radians, positive to the left. The back wheels have the opposite angle."""


Measurement = ProgressReport | MotorReport | ImuReading | GpsFix


class RoverModel:
    """Rover whose time advances in steps; see the module."""

    def __init__(self, seed: int, settings: RoverSettings | None = None, start: PlanarPose | None = None) -> None:
        """Place the rover at ``start``, by default at the origin of the map, heading along its x axis (east)."""
        self.settings = settings or RoverSettings()
        self.pose = start or PlanarPose()
        """True pose of base_link in the map."""
        self.now = 0
        """Time in nanoseconds since the start."""
        self.speed = 0.0
        """Speed of the wheels in m/s, negative backwards."""
        self.velocity = 0.0
        """True speed of the rover along its x axis in m/s."""
        self.yaw_rate = 0.0
        """True angular velocity in rad/s."""
        self.rolled = 0.0
        """Distance that the wheels have rolled in metres; driving backwards counts too."""
        self._board = _Board(self.settings)
        self._slips = [
            _Slip(random.Random(f"{seed} {name}"), deviation)  # noqa: S311  # repeatable, not secret
            for name, deviation in (
                ("slip", self.settings.slip),
                ("side", self.settings.side_slip),
                ("yaw", self.settings.yaw_slip),
            )
        ]
        constant = random.Random(f"{seed} constant")  # noqa: S311  # as above
        self._mean_slip = constant.gauss(0, self.settings.mean_slip)
        self._imu = Imu(random.Random(f"{seed} imu"), self.settings.imu, constant.gauss(0, 1))  # noqa: S311  # as above
        self._gps = GpsReceiver(random.Random(f"{seed} gps"), self.settings.gps)  # noqa: S311  # as above
        self._yaw_before = self.pose.yaw
        self._speed_before = 0.0

    def command(self, command: BoardCommand) -> None:
        """Let the driving board receive a command now. A board that restarts does not receive it.

        Raises `ValueError` if a value is not finite.
        """
        self._board.receive(command)

    def restart_board(self) -> None:
        """Let the driving board restart: it forgets its command, the motors brake, and it reports nothing meanwhile."""
        self._board.restart(self.now)

    def advance(self, seconds: float) -> list[Measurement]:
        """Advance the time by whole steps of `STEP_NS`, and return what the boards measure, in order of time."""
        measured: list[Measurement] = []
        for _ in range(round(seconds / _STEP_S)):
            self._step()
            measured += self._measure()
        return measured

    def _step(self) -> None:
        self.now += STEP_NS
        distance = self._board.step(self.now)
        self.speed = self._board.speed
        slip, side, yaw = (process.after(abs(distance)) for process in self._slips)
        moved = distance * (1 - slip - self._mean_slip)
        arc = Arc(moved, self._board.curvature + yaw)
        self.pose = self.pose @ arc.end @ PlanarPose(0, distance * side, 0)
        self.velocity, self.yaw_rate = moved / _STEP_S, arc.turn / _STEP_S
        self.rolled += abs(distance)

    def _measure(self) -> list[Measurement]:
        settings, now, measured = self.settings, self.now, list[Measurement]()
        if now % settings.imu_period == 0:
            measured.append(self._imu.reading(now, self._motion(period := settings.imu_period / 1e9), period))
        if self._board.runs:
            if now % settings.progress_period == 0:
                measured.append(self._board.progress(now))
            if now % settings.motors_period == 0:
                measured.append(self._motors())
        if now % settings.gps_period == 0:
            measured.append(self._gps.fix(now, self.pose, self.velocity))
        return measured

    def _motion(self, period: float) -> Motion:
        """Return the motion since the last reading of the IMU. An IMU averages over this time."""
        motion = Motion(
            self.pose.yaw,
            (self.pose.yaw - self._yaw_before) / period,
            self.velocity,
            (self.velocity - self._speed_before) / period,
        )
        self._yaw_before, self._speed_before = self.pose.yaw, self.velocity
        return motion

    def _motors(self) -> MotorReport:
        curvature, half = self._board.curvature, self.settings.track / 2
        rpm = self.speed / self.settings.wheel_radius / (2 * math.pi) * 60
        return MotorReport(
            self.now,
            BoardState.OPERATING if self._board.left or self.speed else BoardState.IDLE,
            rpm * (1 - half * curvature),
            rpm * (1 + half * curvature),
            math.atan(self.settings.wheelbase / 2 * curvature),
        )


class _Slip:
    """Gauss-Markov process over the rolled distance."""

    def __init__(self, generator: random.Random, deviation: float) -> None:
        self._generator, self._deviation = generator, deviation
        self._value = generator.gauss(0, deviation)

    def after(self, distance: float) -> float:
        """Return the slip after ``distance`` more metres."""
        if distance:
            kept = math.exp(-distance / SLIP_LENGTH_M)
            self._value = kept * self._value + self._generator.gauss(0, self._deviation * math.sqrt(1 - kept * kept))
        return self._value


class _Board:
    """Driving board: it drives the arc of its command with limited speed, acceleration and curvature."""

    def __init__(self, settings: RoverSettings) -> None:
        self._settings = settings
        self._ready_at = 0
        self._aim = 0.0
        self.left = 0.0
        """Distance left in metres, negative backwards; 0 after a stop, also while the board brakes."""
        self.speed = 0.0
        """Speed of the wheels in m/s."""
        self.curvature = 0.0
        """Curvature in 1/m of the arc that the steered wheels drive now."""
        self._odometer, self._number = 0.0, 0

    def receive(self, command: BoardCommand) -> None:
        """Replace the current command, unless the board restarts."""
        arc = self._settings.board.drivable(self._settings.board.arc(command))
        if self._ready_at == 0:
            self.left = arc.length
            self._aim = arc.curvature if arc.length else self.curvature
            self._number = command.command_number

    def restart(self, now: int) -> None:
        """Forget the command; the board is ready again after a while."""
        self.left, self._aim = 0.0, self.curvature
        self._odometer, self._number = 0.0, 0
        self._ready_at = now + round(self._settings.restart_time * 1e9)

    @property
    def runs(self) -> bool:
        """True if the board does not restart now."""
        return self._ready_at == 0

    def step(self, now: int) -> float:
        """Drive for a time step, and return the distance in metres that the wheels have rolled."""
        settings = self._settings
        if now >= self._ready_at:
            self._ready_at = 0
        self.curvature = _towards(self._aim, self.curvature, settings.steering_rate * _STEP_S)
        wanted = 0.0
        if self.left * self.speed >= 0:  # else it brakes first, because it drives in the other direction
            # From this speed, the board can stop at the end of the arc.
            wanted = math.copysign(
                min(settings.speed, math.sqrt(2 * settings.acceleration * abs(self.left))), self.left
            )
        rate = settings.acceleration if abs(wanted) > abs(self.speed) else settings.braking
        self.speed = _towards(wanted, self.speed, rate * _STEP_S)
        distance = self.speed * _STEP_S
        if self.left:
            if distance / self.left >= 1:
                distance = self.left
            self.left -= distance
        if self.runs:
            self._odometer += distance
        return distance

    def progress(self, now: int) -> ProgressReport:
        """Return the report of the board."""
        return ProgressReport(now, self.left, self._odometer, self._number)


def _towards(aim: float, value: float, change: float) -> float:
    """Return a value that is moved towards an aim by a change, which is limited."""
    return value + min(max(aim - value, -change), change)
