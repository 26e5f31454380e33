"""Motion between two points of the odometry, and how the errors before it continue in it.

The errors of slip in successive motions are taken for independent. Slip goes on for some way. So a motion that is
shorter than this way has a smaller error than the odometry says, and successive motions have similar ones. But no
message says how far it goes on: it is 0.1 m for the robots of MRCLAM, and 0.5 m for the simulated rover. With a longer
way than the true one, the covariance would be too small. With none, that of short motions is too large.

The bias and the scale of a gyroscope stay the same, so that the error of one turn tells much about that of the next
one. The state has the error of the odometry's yaw since its start, in units of its standard deviation in the message,
which is y before and Y after the motion. If c is the correlation of both errors, and e the error before, the error of
the turn is (c Y - y) e + Y sqrt(1 - c^2) w, with an independent w of variance 1, and the error after is c e +
sqrt(1 - c^2) w. So the covariance of the odometry comes back, however many poses the graph has on the way.

The mean of the slip stays the same, too. The state has it in units of its standard deviation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from roverkit.driving.arcs import PlanarPose
from roverkit.fusion.planar_gaussian import Floats, PlanarGaussian, adjoint, rotation

STATES = 5
"""Size of the rover's state: x, y, yaw, and the errors of the odometry that last: those of the yaw, and mean slip."""
ERRORS = STATES - 3
_POSE = slice(0, 3)


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
    """Derivative (3, 2) of the pose by the errors at the start, in the axes of the end."""
    kept: Floats
    """Parts (2,) of the errors that are left at the end."""
    covariance: Floats
    """Covariance (5, 5) of the state at the end if that at the start is known, in the axes of the end."""

    def state_after(self, start: Floats) -> Floats:
        """Return the state (5,) at the end that follows from the one at the start."""
        errors = start[3:]
        return state_of(
            pose_of(start) @ self.pose @ PlanarPose(*(self.by_errors @ errors).tolist()), self.kept * errors
        )

    @property
    def gaussian(self) -> PlanarGaussian:
        """Pose of the end in the frame of the start if nothing is known about the errors."""
        return self.pose_after(np.zeros(STATES), np.diag([0.0, 0, 0, *[1] * ERRORS]))

    def pose_after(self, start: Floats, covariance: Floats) -> PlanarGaussian:
        """Return the pose at the end from the state at the start with its covariance (5, 5), in the outer axes."""
        carried = np.hstack([adjoint(self.pose.inverse()) @ rotation(start[2]).T, self.by_errors])
        spread = carried @ covariance @ carried.T + self.covariance[_POSE, _POSE]
        return PlanarGaussian(pose_of(self.state_after(start)), spread)


def slipping_motion(pose: PlanarPose, growth: Floats, yaw: YawError, mean_slip: float = 0.0) -> SlippingMotion:
    """Return a motion from its pose by odometry, and from the growth (2, 2) of the covariance by slip.

    The growth is in the axes of the end. ``mean_slip`` is the standard deviation of the slip's mean, if the growth does
    not contain it.
    """
    lever = turn_lever(pose)
    by_errors = np.zeros((3, ERRORS))
    by_errors[:, 0] = lever * (yaw.correlation * yaw.after - yaw.before)
    back = pose.inverse()
    by_errors[:2, 1] = mean_slip * np.array([back.x, back.y])
    covariance = np.zeros((STATES, STATES))
    covariance[:2, :2] = _nearest(growth)
    new = np.concatenate([lever * yaw.after, [1, 0]])
    covariance += (1 - yaw.correlation**2) * np.outer(new, new)
    return SlippingMotion(pose, by_errors, np.array([yaw.correlation, 1.0]), covariance)


def turn_lever(pose: PlanarPose) -> Floats:
    """Return the derivative (3,) of the end of a motion by an error of its turn that grew evenly, in its axes."""
    back = pose.inverse()
    return np.array([back.y / 2, -back.x / 2, 1.0])


def state_of(pose: PlanarPose, errors: Floats) -> Floats:
    """Return a state (5,) of the rover."""
    return np.array([pose.x, pose.y, pose.yaw, *errors])


def pose_of(state: Floats) -> PlanarPose:
    """Return the pose of a state."""
    return PlanarPose(*state[:3].tolist())


def _nearest(matrix: Floats) -> Floats:
    """Return the nearest covariance matrix, which has no negative variances."""
    variances, axes = np.linalg.eigh((matrix + matrix.T) / 2)
    nearest: Floats = axes * np.maximum(variances, 0) @ axes.T
    return nearest
