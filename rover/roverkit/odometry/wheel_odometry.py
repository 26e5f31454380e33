"""Odometry from the driving board and a gyroscope: where the rover is in the frame odom, and how fast it drives.

The distance comes from the reports of the driving board. The turn comes from the gyroscope; while it sends nothing, the
turn comes from the curvature of the commands, which is far less exact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from roverkit.driving.arcs import Arc, PlanarPose
from roverkit.gating import Reasons
from roverkit.odometry.dead_reckoning import DeadReckoning, Matrix, OdometryNoise
from roverkit.odometry.odometer import OdometerDistance
from roverkit.odometry.rolled_distance import Rolled, RolledDistance

_GYRO_TIMEOUT_S = 0.2
"""Time without a reading after which the gyroscope is not used."""
_REGULAR_S = 0.05
"""Time between two readings up to which none is missing."""
_ANGULAR_ACCELERATION = 1.0
"""Change of the angular velocity in rad/s^2 that may have remained unseen between two readings."""
_STEERING_M = 0.1
"""Distance in metres that the rover drives until its wheels have the curvature of a new command."""
_UNKNOWN_CURVATURE = 1.0
"""Standard deviation of the turn in radians, after one metre of a command that is not known."""
_COMPARED_M = 1.0
"""Distance in metres after which the gyroscope is compared with the steering: far more than the slip's correlation."""
_WATCHED_M = 5.0
"""Distance in metres over which the errors that cannot be known are compared with the slip."""
_BIAS = "bias of the gyroscope"
SPEED_DEVIATION = 0.01
"""Standard deviation in m/s of the speed between two reports, beyond slip."""


@dataclass(frozen=True, slots=True)
class OdometryEstimate:
    """Pose in the frame odom and velocity in base_link, with their uncertainties."""

    at: int
    """Time in nanoseconds."""
    pose: PlanarPose
    covariance: Matrix
    """Covariance (3, 3) of x, y in metres and yaw in radians, in the axes of odom."""
    speed: float
    """Speed along x in m/s."""
    yaw_rate: float
    """Angular velocity in rad/s."""
    speed_variance: float
    yaw_rate_variance: float


class WheelOdometry:
    """Odometry; all times are in nanoseconds of one clock."""

    def __init__(
        self, noise: OdometryNoise | None = None, reasons: Reasons | None = None, *, has_odometer: bool = False
    ) -> None:
        """``has_odometer`` is true if the driving board reports its odometer, so that no distance is estimated."""
        self.reasons = reasons or Reasons()
        """Reasons why inputs are left out, and why something is not known."""
        self._reckoning = DeadReckoning(noise or OdometryNoise(), self.reasons)
        self._wheels = OdometerDistance() if has_odometer else RolledDistance()
        self._gyroscope = _Gyroscope()
        self._curvature: float | None = 0.0
        self._yaw_rate = 0.0
        self._yaw_rate_variance = self.noise.gyro_noise**2 / _REGULAR_S
        """Variance of the angular velocity without that of errors that stay the same."""
        self._reported_at: int | None = None
        self._compared = _Comparison()
        self._way = self._unsure = self._unsure_part = 0.0
        self.distance_scale = 1.0
        """True distance, as a part of the distance that the board reports; it may be replaced at any time."""
        self.uses_gyroscope = True
        """False if the turn of the last distance is that of the steering, because the gyroscope sent nothing."""

    @property
    def noise(self) -> OdometryNoise:
        """Standard deviations of the errors; they may be replaced at any time."""
        return self._reckoning.noise

    @noise.setter
    def noise(self, noise: OdometryNoise) -> None:
        self._reckoning.noise = noise

    @property
    def ignored(self) -> int:
        """Number of reports that were ignored, because nothing explained them."""
        return self._wheels.ignored

    def command(self, now: int, arc: Arc, number: int = 0) -> None:
        """Take a command that is sent to the driving board now: the arc that the board drives for it, and its number.

        The number is 0 if it has none.
        """
        self._wheels.command(now, arc, number)

    def motors(self, now: int, rpm: float) -> None:
        """Take the mean speed of the wheels' motors, each without its sign, in revolutions per minute."""
        self._wheels.motors(now, rpm)

    def angular_velocity(self, at: int, rate: float) -> None:
        """Take the angular velocity of base_link about z, in rad/s, that the gyroscope measured at a time."""
        self._gyroscope.add(at, rate)

    def progress(
        self, now: int, distance_left: float, odometer: float | None = None, number: int | None = None
    ) -> OdometryEstimate | None:
        """Take a report of the driving board, and return the new estimate; None if the report is ignored.

        ``odometer`` is in metres since the start of the board, and ``number`` is that of the newest command that the
        board has taken; each is None if the board does not report it.
        """
        if isinstance(self._wheels, OdometerDistance):
            rolled = self._wheels.report(now, distance_left, odometer or 0.0, number)
        else:
            rolled = self._wheels.report(now, distance_left, number)
        if rolled is None:
            return None
        rolled = rolled.scaled(self.distance_scale)
        self._reported_at = now
        if rolled.until > rolled.since:
            self._move(rolled)
        else:
            self._gyroscope.take_turn(now)
        self._curvature = rolled.curvature
        return self._estimate(now, 0.0)

    def silent(self, now: int) -> OdometryEstimate | None:
        """Return the last estimate while the board reports nothing; None if it has reported nothing yet.

        The rover may have driven on along its arc since then, so that the position is less certain.
        """
        return None if self._reported_at is None else self._estimate(now, self._wheels.unreported(now))

    def _move(self, rolled: Rolled) -> None:
        seconds = (rolled.until - rolled.since) / 1e9
        self._watch(rolled)
        turn = self._gyroscope.take_turn(rolled.until)
        if turn is None:
            self._steer(rolled, seconds)
            return
        self.uses_gyroscope = True
        self._yaw_rate = turn.rate - self._reckoning.bias
        self._yaw_rate_variance = (self.noise.gyro_noise**2 * seconds + turn.variance) / seconds**2
        stands = self._wheels.stands(rolled.until)
        if self._reckoning.knows_bias:
            self.reasons.give(_BIAS)
        else:
            self.reasons.lack(_BIAS, "the rover has not stood since the start", rolled.until)
        if stands and self._reckoning.stand(turn.angle / seconds, seconds):
            self._yaw_rate = 0.0
        elif stands or rolled.distance or self._reckoning.knows_bias:  # else, the frame odom has not begun yet
            self._reckoning.turn_by_gyroscope(rolled, turn.angle, seconds, turn.variance)

        self._compare(rolled, turn.angle - self._reckoning.bias * seconds)

    def _watch(self, rolled: Rolled) -> None:
        """Say so if errors that cannot be known are larger than the slip."""
        self._way += abs(rolled.distance)
        self._unsure += abs(rolled.unsure)
        if self._way < _WATCHED_M:
            return
        self._unsure_part, self._way, self._unsure = self._unsure / self._way, 0.0, 0.0
        if self._unsure_part > self.noise.slip:
            self.reasons.note(
                "the distance is uncertain: commands come too quickly for the reports, or the reports are rounded",
                f"{self._unsure_part:.0%} of the distance",
            )

    def _compare(self, rolled: Rolled, turn: float) -> None:
        """Compare the turn by the gyroscope with that of the steering: an IMU may be mounted upside down."""
        if rolled.curvature is None or self._curvature is None:
            return
        compared = self._compared
        compared.distance += abs(rolled.distance)
        compared.by_gyroscope += turn
        compared.by_steering += rolled.distance * rolled.curvature
        compared.variance += ((rolled.curvature - self._curvature) * 2 * _STEERING_M) ** 2
        if compared.distance < _COMPARED_M:
            return
        self._compared = _Comparison(before=compared.variance)
        variance = compared.variance + compared.before + self.noise.yaw_slip**2 * compared.distance
        self.reasons.passes(
            "the gyroscope and the steering disagree; is the IMU mounted upside down, or is smallest_radius wrong?",
            (compared.by_gyroscope - compared.by_steering) ** 2 / variance,
            1,
            f"{compared.by_gyroscope:.2f} instead of {compared.by_steering:.2f} rad in {compared.distance:.1f} m",
        )

    def _steer(self, rolled: Rolled, seconds: float) -> None:
        """Move along the arc of the command, because the gyroscope sends nothing."""
        if rolled.distance:
            self.reasons.note("no angular velocity comes from the IMU; the turn is that of the steering")
            self.uses_gyroscope = False
        if rolled.curvature is None:
            curvature, variance = 0.0, _UNKNOWN_CURVATURE**2 * abs(rolled.distance)
        else:
            curvature = rolled.curvature
            variance = ((curvature - (self._curvature or 0.0)) * _STEERING_M) ** 2
        self._yaw_rate = rolled.distance * curvature / seconds
        self._reckoning.turn_by_steering(rolled, curvature, variance, seconds)
        self._yaw_rate_variance = self._reckoning.new_yaw_variance / seconds**2

    def _estimate(self, now: int, unreported: float) -> OdometryEstimate:
        noise, speed = self.noise, self._wheels.speed * self.distance_scale
        covariance = self._reckoning.covariance
        for axis in range(2):
            covariance[axis][axis] += unreported**2
        moving = (math.hypot(noise.slip, self._unsure_part) * speed) ** 2 + SPEED_DEVIATION**2
        turning = self._yaw_rate_variance + (
            self._reckoning.bias_variance + (noise.gyro_scale * self._yaw_rate) ** 2
            if self.uses_gyroscope
            else SPEED_DEVIATION**2
        )
        silent = speed**2 if unreported else 0.0
        return OdometryEstimate(
            now, self._reckoning.pose, covariance, speed, self._yaw_rate, moving + silent, turning + silent
        )


@dataclass(slots=True)
class _Comparison:
    """Turn over a distance in metres by the gyroscope and by the steering, in radians."""

    distance: float = 0.0
    by_gyroscope: float = 0.0
    by_steering: float = 0.0
    variance: float = 0.0
    """Variance of the difference in rad^2 by changes of the steering, which take some time."""
    before: float = 0.0
    """The same of the distance before, whose last change may go on."""


@dataclass(frozen=True, slots=True)
class _Turn:
    """Turn that the gyroscope measured, with its bias."""

    angle: float
    """Angle in radians."""
    rate: float
    """Angular velocity at the end in rad/s."""
    variance: float
    """Variance of the angle in rad^2 because of lost readings."""


class _Gyroscope:
    """Integral of the angular velocity."""

    def __init__(self) -> None:
        self._at: int | None = None
        self._rate = self._angle = self._variance = 0.0
        self._taken: float | None = None
        """Angle at the last call of `take_turn`; None if the angle has been unknown since then."""

    def add(self, at: int, rate: float) -> None:
        """Take a reading."""
        seconds = 0.0 if self._at is None else (at - self._at) / 1e9
        if 0 <= seconds <= _GYRO_TIMEOUT_S:
            self._angle += (self._rate + rate) / 2 * seconds
            if seconds > _REGULAR_S:
                self._variance += (_ANGULAR_ACCELERATION * seconds**2 / 4) ** 2
        else:
            self._taken = None
        self._at, self._rate = at, rate

    def take_turn(self, now: int) -> _Turn | None:
        """Return the turn since the last call; None if readings are missing."""
        before, variance = self._taken, self._variance
        self._taken, self._variance = None, 0.0
        if self._at is None or abs(seconds := (now - self._at) / 1e9) > _GYRO_TIMEOUT_S:
            return None
        # The next reading replaces the part since the last one.
        self._taken = self._angle + self._rate * seconds
        if abs(seconds) > _REGULAR_S:
            variance += (_ANGULAR_ACCELERATION * seconds**2 / 2) ** 2
        return None if before is None else _Turn(self._taken - before, self._rate, variance)
