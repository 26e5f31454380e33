"""Dead reckoning on a plane: pose, bias of the gyroscope and their covariance, from distances and turns.

This is the prediction of an extended Kalman filter with the state x, y, yaw, bias, and the relative error of distances
that were computed from a speed because no report contains them. There is no outside measurement.
While the rover stands, the gyroscope shows its bias, which is then estimated. Only the bias changes by this, and not
the pose, although their errors are correlated (a Schmidt-Kalman update): the frame odom has no jumps (REP 105).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

from roverkit.driving.arcs import Arc, PlanarPose

Matrix = list[list[float]]
"""Matrix as a list of rows."""
_GUESS = 0.03
"""Standard deviation of the relative error of distances that no report contains; it is the same for all of them."""
_STATES = 5
_STANDING_RATE = 0.05
"""Angular velocity in rad/s from which a rover turns although its wheels stand."""


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


class Distance(Protocol):
    """Distance that the wheels have rolled."""

    @property
    def distance(self) -> float:
        """Distance in metres, negative backwards."""

    @property
    def guessed(self) -> float:
        """Part of the distance that no report contains."""

    @property
    def variance(self) -> float:
        """Variance of this part in m^2, beyond that of its relative error."""


class DeadReckoning:
    """Pose of the rover in the frame odom, which is its frame at the start, with the covariance."""

    def __init__(self, noise: OdometryNoise) -> None:
        self.noise = noise
        self.pose = PlanarPose()
        self.bias = 0.0
        """Bias of the gyroscope about z in rad/s."""
        self._covariance: Matrix = [[0.0] * _STATES for _ in range(_STATES)]
        self._covariance[3][3], self._covariance[4][4] = noise.gyro_bias**2, _GUESS**2

    @property
    def covariance(self) -> Matrix:
        """Covariance (3, 3) of x, y in metres and yaw in radians."""
        return [row[:3] for row in self._covariance[:3]]

    @property
    def bias_variance(self) -> float:
        """Variance of the bias in (rad/s)^2."""
        return self._covariance[3][3]

    def turn_by_gyroscope(self, rolled: Distance, angle: float, seconds: float, gap: float) -> None:
        """Move by a distance, and turn by an angle in radians that the gyroscope measured in some seconds.

        ``angle`` still contains the bias. ``gap`` is its additional variance, from readings that were lost.
        """
        turn, distance = angle - self.bias * seconds, rolled.distance
        self._move(Arc(distance, turn / distance) if distance else None, turn, -seconds, rolled.guessed)
        self._grow(distance, rolled.variance, self.noise.gyro_noise**2 * seconds + gap, 0.0)
        self._covariance[3][3] += self.noise.gyro_bias_walk**2 * seconds

    def turn_by_steering(self, rolled: Distance, curvature: float, yaw_variance: float, seconds: float) -> None:
        """Move along an arc with a curvature in 1/m, and with a variance of its turn beyond that of the slip."""
        arc = Arc(rolled.distance, curvature)
        self._move(arc, arc.turn, 0.0, rolled.guessed)
        self._grow(arc.length, rolled.variance, self.noise.yaw_slip**2 * abs(arc.length) + yaw_variance, arc.curvature)
        self._covariance[3][3] += self.noise.gyro_bias_walk**2 * seconds

    def stand(self, rate: float, seconds: float) -> bool:
        """Take the mean angular velocity in rad/s, with its bias, that the gyroscope shows while the rover stands.

        Returns false if it shows that the rover turns although its wheels stand.
        """
        miss = rate - self.bias
        covariance, noise = self._covariance, self.noise.gyro_noise**2 / seconds
        prior = covariance[3][3] + self.noise.gyro_bias_walk**2 * seconds
        if abs(miss) > _STANDING_RATE:
            return False
        gain = prior / (prior + noise)
        self.bias += gain * miss
        covariance[3][3] = (1 - gain) * prior
        for index in (0, 1, 2, 4):
            covariance[3][index] = covariance[index][3] = (1 - gain) * covariance[index][3]
        return True

    def _move(self, arc: Arc | None, turn: float, yaw_by_bias: float, guessed: float) -> None:
        """Change the pose, and carry its errors along.

        ``yaw_by_bias`` is the derivative of the turn, and ``guessed`` that of the distance by its relative error.
        """
        before = self.pose
        self.pose = before @ (arc.end if arc else PlanarPose(0, 0, turn))
        dx, dy = self.pose.x - before.x, self.pose.y - before.y
        # The chord has the direction of the yaw in the middle of the arc, which has half of the turn's error.
        middle = before.yaw + turn / 2
        transition = [
            [1.0, 0.0, -dy, -dy * yaw_by_bias / 2, guessed * math.cos(middle)],
            [0.0, 1.0, dx, dx * yaw_by_bias / 2, guessed * math.sin(middle)],
            [0.0, 0.0, 1.0, yaw_by_bias, 0.0],
            [0.0, 0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, 1.0],
        ]
        half = _product(transition, self._covariance)
        moved = _product(half, [list(column) for column in zip(*transition)])
        # Rounding must not make it asymmetric.
        states = range(_STATES)
        self._covariance = [[moved[min(row, column)][max(row, column)] for column in states] for row in states]

    def _grow(self, distance: float, variance: float, yaw_variance: float, curvature: float) -> None:
        """Add the errors of a distance, of the motion to the side, and of the turn; see `OdometryNoise`."""
        direction = self.pose.yaw
        cosine, sine = math.cos(direction), math.sin(direction)
        along = self.noise.slip**2 * abs(distance) + variance
        side = self.noise.side_slip**2 * abs(distance)
        covariance = self._covariance
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


def _product(left: Matrix, right: Matrix) -> Matrix:
    columns = list(zip(*right))
    return [[sum(value * other for value, other in zip(row, column)) for column in columns] for row in left]
