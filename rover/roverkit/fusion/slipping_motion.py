"""Motion between two points of the odometry, and how the errors before it continue in it.

Slip is correlated: wheels that slip go on slipping for a while. The odometry says that the variance of the position
grows by G over a distance d, and this is right if d is far longer than the correlation length L of the slip. The error
of a shorter motion is smaller, but successive motions have similar errors. So the slip ahead and sideways is a part of
the state of the rover, in units of its standard deviation s.

The model is that of the simulated rover: a Gauss-Markov (Ornstein-Uhlenbeck) process z over the distance, with the
correlation r = exp(-d / L). With u = d / L and G = 2 s^2 L d, its integral, the error of the motion, has these moments
(Gillespie, Exact numerical simulation of the Ornstein-Uhlenbeck process and its integral, 1996):

| quantity                                     | value                             |
|----------------------------------------------|-----------------------------------|
| mean of the error, given z at the start      | z sqrt(G) (1 - r) / sqrt(2 u)     |
| variance of the error, given z at the start  | G (2 u - 3 + 4 r - r^2) / (2 u)   |
| mean of z at the end                         | r z                               |
| variance of z at the end                     | 1 - r^2                           |
| covariance of the error with z at the end    | sqrt(G) (1 - r)^2 / sqrt(2 u)     |

The bias and the scale of a gyroscope stay the same, so that the error of one turn tells much about that of the next
one. The state has the error of the odometry's yaw since its start, in units of its standard deviation in the message,
which is y before and Y after the motion. If c is the correlation of both errors, and e the error before, the error of
the turn is (c Y - y) e + Y sqrt(1 - c^2) w, with an independent w of variance 1, and the error after is c e +
sqrt(1 - c^2) w. So the covariance of the odometry comes back, however many poses the graph has on the way.

The mean of the slip stays the same, too. The state has it in units of its standard deviation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from roverkit.driving.arcs import PlanarPose
from roverkit.fusion.planar_gaussian import Floats, PlanarGaussian, adjoint, rotation
from roverkit.simulation.rover_model import SLIP_LENGTH_M

STATES = 7
"""Size of the rover's state: x, y, yaw, and the errors of the odometry: slip ahead and sideways, yaw, and mean slip."""
ERRORS = STATES - 3
_SLIP, _POSE = slice(3, 5), slice(0, 3)
_FLOOR = np.diag([1e-3] * STATES) ** 2
"""Least covariance of a motion: a millimetre and a milliradian. GTSAM cannot invert that of an exact motion."""
_MOST_SLIP = 0.3
"""Standard deviation of the slip that no rover has. What grows faster is not slip: a silent board, for example."""
_SHORTEST = 1e-3
"""Least distance in correlation lengths: below, rounding is larger than the error of the motion."""


@dataclass(frozen=True, slots=True)
class YawError:
    """Error of the odometry's yaw before and after a motion."""

    before: float
    """Standard deviation in radians; so is ``after``."""
    after: float
    correlation: float


@dataclass(frozen=True, slots=True, eq=False)
class SlippingMotion:
    """Pose of the end in the frame of the start, as a function of the errors at the start."""

    pose: PlanarPose
    """Pose without errors at the start."""
    by_errors: Floats
    """Derivative (3, 4) of the pose by the errors at the start, in the axes of the end."""
    kept: Floats
    """Parts (4,) of the errors that are left at the end."""
    covariance: Floats
    """Covariance (7, 7) of the state at the end if that at the start is known, in the axes of the end."""

    def state_after(self, start: Floats) -> Floats:
        """Return the state (7,) at the end that follows from the one at the start."""
        errors = start[3:]
        return state_of(
            pose_of(start) @ self.pose @ PlanarPose(*(self.by_errors @ errors).tolist()), self.kept * errors
        )

    @property
    def gaussian(self) -> PlanarGaussian:
        """Pose of the end in the frame of the start if nothing is known about the errors."""
        return self.pose_after(np.zeros(STATES), np.diag([0.0, 0, 0, *[1] * ERRORS]))

    def pose_after(self, start: Floats, covariance: Floats) -> PlanarGaussian:
        """Return the pose at the end from the state at the start with its covariance (7, 7), in the outer axes."""
        carried = np.hstack([adjoint(self.pose.inverse()) @ rotation(start[2]).T, self.by_errors])
        spread = carried @ covariance @ carried.T + self.covariance[_POSE, _POSE]
        return PlanarGaussian(pose_of(self.state_after(start)), spread)


def slipping_motion(
    pose: PlanarPose, growth: Floats, distance: float, yaw: YawError, mean_slip: float = 0.0
) -> SlippingMotion:
    """Return a motion from its pose by odometry, and from the growth (2, 2) of the covariance by slip.

    The growth is in the axes of the end. ``distance`` is what the rover has driven, in metres. ``mean_slip`` is the
    standard deviation of the slip's mean, if the growth does not contain it.
    """
    root = math.copysign(1.0, pose.x) * _root(growth)
    root *= min(1.0, _MOST_SLIP * math.sqrt(2 * SLIP_LENGTH_M * distance) / (float(np.linalg.norm(root)) or 1.0))
    length = max(distance / SLIP_LENGTH_M, _SHORTEST)
    kept = math.exp(-length)
    scale = (1 - kept) / math.sqrt(2 * length)
    uncorrelated = (2 * length - 3 + 4 * kept - kept**2) / (2 * length)
    lever = turn_lever(pose)
    by_errors = np.zeros((3, ERRORS))
    by_errors[:2, :2] = root * scale
    by_errors[:, 2] = lever * (yaw.correlation * yaw.after - yaw.before)
    back = pose.inverse()
    by_errors[:2, 3] = mean_slip * np.array([back.x, back.y])
    covariance = _FLOOR.copy()
    # The uncertainty by a silent board ends when it speaks again, and is no slip.
    covariance[:2, :2] += _squared(growth) - (1 - uncorrelated) * root @ root.T
    covariance[:2, _SLIP] = root * (1 - kept) * scale
    covariance[_SLIP, :2] = covariance[:2, _SLIP].T
    covariance[_SLIP, _SLIP] += (1 - kept**2) * np.eye(2)
    new = np.concatenate([lever * yaw.after, [0, 0, 1, 0]])
    covariance += (1 - yaw.correlation**2) * np.outer(new, new)
    return SlippingMotion(pose, by_errors, np.array([kept, kept, yaw.correlation, 1.0]), covariance)


def turn_lever(pose: PlanarPose) -> Floats:
    """Return the derivative (3,) of the end of a motion by an error of its turn that grew evenly, in its axes."""
    back = pose.inverse()
    return np.array([back.y / 2, -back.x / 2, 1.0])


def state_of(pose: PlanarPose, errors: Floats) -> Floats:
    """Return a state (7,) of the rover."""
    return np.array([pose.x, pose.y, pose.yaw, *errors])


def pose_of(state: Floats) -> PlanarPose:
    """Return the pose of a state."""
    return PlanarPose(*state[:3].tolist())


def _squared(matrix: Floats) -> Floats:
    """Return the nearest matrix without negative variances."""
    root = _root(matrix)
    return root @ root


def _root(matrix: Floats) -> Floats:
    """Return the symmetric square root of the nearest matrix without negative variances."""
    variances, axes = np.linalg.eigh((matrix + matrix.T) / 2)
    root: Floats = axes * np.sqrt(np.maximum(variances, 0)) @ axes.T
    return root
