"""Motion between two points of the odometry, and how the slip before it continues in it.

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
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from roverkit.driving.arcs import PlanarPose
from roverkit.fusion.planar_gaussian import Floats, PlanarGaussian, adjoint, rotation
from roverkit.simulation.rover_model import SLIP_LENGTH_M

STATES = 5
"""Size of the rover's state: x, y, yaw, and the slip ahead and sideways."""
_FLOOR = np.diag([1e-3, 1e-3, 5e-4, 1e-3, 1e-3]) ** 2
"""Least covariance of a motion: a millimetre and half a milliradian. GTSAM cannot invert that of an exact motion."""
_MOST_SLIP = 0.3
"""Standard deviation of the slip that no rover has. What grows faster is not slip: a silent board, for example."""
_SHORTEST = 1e-3
"""Least distance in correlation lengths: below, rounding is larger than the error of the motion."""


@dataclass(frozen=True, slots=True, eq=False)
class SlippingMotion:
    """Pose of the end in the frame of the start, as a function of the slip at the start."""

    pose: PlanarPose
    """Pose without slip at the start."""
    by_slip: Floats
    """Derivative (3, 2) of the pose by the slip at the start, in the axes of the end."""
    kept: float
    """Part of the slip that is left at the end."""
    covariance: Floats
    """Covariance (5, 5) of the state at the end if that at the start is known, in the axes of the end."""

    def state_after(self, start: Floats) -> Floats:
        """Return the state (5,) at the end that follows from the one at the start."""
        slip = start[3:]
        return state_of(pose_of(start) @ self.pose @ PlanarPose(*(self.by_slip @ slip).tolist()), self.kept * slip)

    @property
    def gaussian(self) -> PlanarGaussian:
        """Pose of the end in the frame of the start if nothing is known about the slip."""
        return self.pose_after(np.zeros(STATES), np.diag([0.0, 0, 0, 1, 1]))

    def pose_after(self, start: Floats, covariance: Floats) -> PlanarGaussian:
        """Return the pose at the end from the state at the start with its covariance (5, 5), in the outer axes."""
        carried = np.hstack([adjoint(self.pose.inverse()) @ rotation(start[2]).T, self.by_slip])
        spread = carried @ covariance @ carried.T + self.covariance[:3, :3]
        return PlanarGaussian(pose_of(self.state_after(start)), spread)


def slipping_motion(pose: PlanarPose, growth: Floats, distance: float) -> SlippingMotion:
    """Return a motion from its pose by odometry, and from the growth (3, 3) of the covariance in the axes of the end.

    ``distance`` is what the rover has driven, in metres.
    """
    # The uncertainty by a silent board ends when it speaks again, and rounding leaves negative variances, too.
    grown = (whole := _root(growth)) @ whole
    by_yaw = np.outer(grown[2], grown[2]) / (grown[2, 2] + _FLOOR[2, 2])
    root = math.copysign(1.0, pose.x) * _root(grown - by_yaw)[:, :2]
    root *= min(1.0, _MOST_SLIP * math.sqrt(2 * SLIP_LENGTH_M * distance) / (float(np.linalg.norm(root)) or 1.0))
    length = max(distance / SLIP_LENGTH_M, _SHORTEST)
    kept = math.exp(-length)
    scale = (1 - kept) / math.sqrt(2 * length)
    uncorrelated = (2 * length - 3 + 4 * kept - kept**2) / (2 * length)
    mixed = root * (1 - kept) * scale
    errors = grown - (1 - uncorrelated) * root @ root.T
    covariance = np.block([[errors, mixed], [mixed.T, (1 - kept**2) * np.eye(2)]]) + _FLOOR
    return SlippingMotion(pose, root * scale, kept, covariance)


def state_of(pose: PlanarPose, slip: Floats) -> Floats:
    """Return a state (5,) of the rover."""
    return np.array([pose.x, pose.y, pose.yaw, *slip])


def pose_of(state: Floats) -> PlanarPose:
    """Return the pose of a state."""
    return PlanarPose(*state[:3].tolist())


def _root(matrix: Floats) -> Floats:
    """Return the symmetric square root of the nearest matrix without negative variances."""
    variances, axes = np.linalg.eigh((matrix + matrix.T) / 2)
    root: Floats = axes * np.sqrt(np.maximum(variances, 0)) @ axes.T
    return root
