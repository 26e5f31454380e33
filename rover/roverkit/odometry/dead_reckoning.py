"""Dead reckoning on a plane: pose, errors of the sensors and their covariance, from distances and turns.

This is the prediction of an extended Kalman filter. Its state is x, y, yaw and four errors that stay the same: the bias
of the gyroscope, the error of distances at changes of the command in units of its standard deviation, the relative
error of the gyroscope's scale, and the mean slip of the wheels. There is no outside measurement.
While the rover stands, the gyroscope shows its bias, which is then estimated. Only the bias changes by this, and not
the pose, although their errors are correlated (a Schmidt-Kalman update): the frame odom has no jumps (REP 105).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from roverkit.driving.arcs import Arc, PlanarPose
from roverkit.gating import Reasons

Matrix = list[list[float]]
"""Matrix as a list of rows."""
_STATES, _BIAS, _POSE = 7, 3, 3
"""Number of states, index of the bias, and number of states of the pose."""
_LARGE_BIAS = 0.11
"""Standard deviation in rad/s of the bias of a cheap gyroscope. The gate then refuses more than 0.36 rad/s. The
data sheet of the MPU-6050 allows a zero-rate output of 0.35 rad/s (20 degrees/s)."""


@dataclass(frozen=True, slots=True)
class OdometryNoise:
    """Standard deviations of the errors. Those after one metre or one second grow with its root."""

    slip: float = 0.05
    """Error of the distance in metres, after one metre."""
    side_slip: float = 0.01
    """Motion to the side in metres, after one metre."""
    yaw_slip: float = 0.03
    """Error of the turn in radians, after one metre, if only the steering and no gyroscope tells the turn."""
    gyro_noise: float = 2.6e-4
    """Error of the turn in radians that the gyroscope measures, after one second."""
    gyro_bias: float = 5e-3
    """Bias of the gyroscope before the rover has stood, in rad/s."""
    gyro_bias_walk: float = 5e-6
    """Change of the bias in rad/s, after one second."""
    gyro_scale: float = 3e-3
    """Relative error of the angular velocity."""
    mean_slip: float = 0.02
    """Mean of the slip, as a part of the distance."""


class Distance(Protocol):
    """Distance that the wheels have rolled."""

    @property
    def distance(self) -> float:
        """Distance in metres, negative backwards."""

    @property
    def unsure(self) -> float:
        """Standard deviation in metres of the error that is the same each time, with the sign of the distance."""

    @property
    def variance(self) -> float:
        """Variance in m^2 of the error of this distance alone."""


class DeadReckoning:
    """Pose of the rover in the frame odom, which is its frame at the start, with the covariance."""

    def __init__(self, noise: OdometryNoise, reasons: Reasons) -> None:
        self.noise, self._reasons = noise, reasons
        self.pose = PlanarPose()
        self.bias = 0.0
        """Bias of the gyroscope about z in rad/s."""
        self.knows_bias = False
        """True if the bias has been learned while the rover stood."""
        deviations = (0.0, 0.0, 0.0, noise.gyro_bias, 1.0, noise.gyro_scale, noise.mean_slip)
        self.new_yaw_variance = 0.0
        """Variance of the last turn in rad^2 by errors that did not exist before it."""
        self._covariance: Matrix = [
            [deviation**2 if row == column else 0.0 for column in range(_STATES)]
            for row, deviation in enumerate(deviations)
        ]

    @property
    def covariance(self) -> Matrix:
        """Covariance (3, 3) of x, y in metres and yaw in radians."""
        return [row[:_POSE] for row in self._covariance[:_POSE]]

    @property
    def bias_variance(self) -> float:
        """Variance of the bias in (rad/s)^2."""
        return self._covariance[_BIAS][_BIAS]

    def turn_by_gyroscope(self, rolled: Distance, angle: float, seconds: float, gap: float) -> None:
        """Move by a distance, and turn by an angle in radians that the gyroscope measured in some seconds.

        ``angle`` still contains the bias. ``gap`` is its additional variance, from readings that were lost.
        """
        turn, distance = angle - self.bias * seconds, rolled.distance
        arc = Arc(distance, turn / distance) if distance else None
        self._move(arc, turn, (-seconds, 0.0, -turn, 0.0), rolled)
        self._grow(distance, rolled.variance, self.noise.gyro_noise**2 * seconds + gap, 0.0)
        self._covariance[_BIAS][_BIAS] += self.noise.gyro_bias_walk**2 * seconds

    def turn_by_steering(self, rolled: Distance, curvature: float, yaw_variance: float, seconds: float) -> None:
        """Move along an arc with a curvature in 1/m, and with a variance of its turn beyond that of the slip."""
        arc = Arc(rolled.distance, curvature)
        self._move(arc, arc.turn, (0.0, rolled.unsure * curvature, 0.0, -arc.turn), rolled)
        self._grow(arc.length, rolled.variance, self.noise.yaw_slip**2 * abs(arc.length) + yaw_variance, arc.curvature)
        self._covariance[_BIAS][_BIAS] += self.noise.gyro_bias_walk**2 * seconds

    def stand(self, rate: float, seconds: float) -> bool:
        """Take the mean angular velocity in rad/s, with its bias, that the gyroscope shows while the rover stands.

        Returns false if the bias does not explain it: the rover turns although its wheels stand.
        """
        miss = rate - self.bias
        covariance, noise = self._covariance, self.noise.gyro_noise**2 / seconds
        prior = covariance[_BIAS][_BIAS] + self.noise.gyro_bias_walk**2 * seconds
        shown = f"the gyroscope shows {rate:.3f} rad/s while the wheels stand"
        if not self.knows_bias and not self._reasons.passes(
            "the bias of the gyroscope is larger than gyro_bias", miss**2 / (prior + noise), 1, shown
        ):
            prior = _LARGE_BIAS**2
        if not self._reasons.passes(
            "the rover turns while its wheels stand, or the noise is above gyro_noise",
            miss**2 / (prior + noise),
            1,
            f"{shown}, and its bias is {self.bias:.3f}",
        ):
            return False
        gain = prior / (prior + noise)
        self.bias += gain * miss
        self.knows_bias = True
        covariance[_BIAS][_BIAS] = (1 - gain) * prior
        for index in range(_STATES):
            if index != _BIAS:
                covariance[_BIAS][index] = covariance[index][_BIAS] = (1 - gain) * covariance[index][_BIAS]
        return True

    def _move(self, arc: Arc | None, turn: float, by_turn: Sequence[float], rolled: Distance) -> None:
        """Change the pose, and carry its errors along.

        ``by_turn`` has the derivatives of the turn by the four errors that stay the same.
        """
        before = self.pose
        self.pose = before @ (arc.end if arc else PlanarPose(0, 0, turn))
        dx, dy = self.pose.x - before.x, self.pose.y - before.y
        # The chord has the direction of the yaw in the middle of the arc, which has half of the turn's error.
        middle = before.yaw + turn / 2
        cosine, sine = math.cos(middle), math.sin(middle)
        by_distance = (0.0, rolled.unsure, 0.0, -rolled.distance)
        errors = [
            (-dy * angle / 2 + length * cosine, dx * angle / 2 + length * sine, angle)
            for angle, length in zip(by_turn, by_distance)
        ]
        # The transition is the identity, except for its first three rows.
        changes = [(0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (-dy, dx, 0.0), *errors]
        covariance = self._covariance
        for _ in range(2):  # from the left, and then transposed from the right
            moved = [
                [
                    value + sum(change[axis] * row[column] for change, row in zip(changes, covariance))
                    for column, value in enumerate(covariance[axis])
                ]
                for axis in range(_POSE)
            ]
            covariance = [list(column) for column in zip(*moved, *covariance[_POSE:])]
        # Rounding must not make it asymmetric.
        states = range(_STATES)
        self._covariance = [[covariance[min(row, column)][max(row, column)] for column in states] for row in states]

    def _grow(self, distance: float, variance: float, yaw_variance: float, curvature: float) -> None:
        """Add the errors of a distance, of the motion to the side, and of the turn; see `OdometryNoise`."""
        direction = self.pose.yaw
        cosine, sine = math.cos(direction), math.sin(direction)
        along = self.noise.slip**2 * abs(distance) + variance
        side = self.noise.side_slip**2 * abs(distance)
        covariance = self._covariance
        self.new_yaw_variance = yaw_variance + along * curvature**2
        # On an arc that is longer than reported, the rover has turned further as well.
        errors = (
            (along, (cosine, sine, curvature)),
            (side, (-sine, cosine, 0.0)),
            (yaw_variance, (0.0, 0.0, 1.0)),
        )
        for size, axis in errors:
            for row in range(3):
                for column in range(3):
                    covariance[row][column] += size * axis[row] * axis[column]
