"""Poses on a plane with their uncertainty.

A covariance (3, 3) is of x and y in metres and of the yaw in radians, in the axes of the pose itself: x is ahead. So an
error e of a pose T is that the true pose is T exp(e), as in GTSAM.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roverkit.driving.arcs import FARTHEST_M, PlanarPose

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class PlanarGaussian:
    """Pose with its covariance."""

    pose: PlanarPose
    covariance: Floats

    def __matmul__(self, other: PlanarGaussian) -> PlanarGaussian:
        """Return the pose, in the outer frame, of what has the pose ``other`` in this frame; errors are independent."""
        carried = adjoint(other.pose.inverse())
        return PlanarGaussian(self.pose @ other.pose, carried @ self.covariance @ carried.T + other.covariance)

    def inverse(self) -> PlanarGaussian:
        """Return the pose of the outer frame in this frame."""
        turned = adjoint(self.pose)
        return PlanarGaussian(self.pose.inverse(), turned @ self.covariance @ turned.T)

    @property
    def outer_covariance(self) -> Floats:
        """Covariance in the axes of the outer frame, as in ROS 2's `PoseWithCovariance`."""
        turned = rotation(self.pose.yaw)
        covariance: Floats = turned @ self.covariance @ turned.T
        return covariance


def adjoint(pose: PlanarPose) -> Floats:
    """Return the matrix (3, 3) that turns a small motion in the axes of a pose into the same one in the outer axes."""
    matrix = rotation(pose.yaw)
    matrix[0, 2], matrix[1, 2] = pose.y, -pose.x
    return matrix


def rotation(yaw: float) -> Floats:
    """Return the matrix (3, 3) that rotates x and y by an angle in radians, and leaves the third component alone."""
    cosine, sine = np.cos(yaw), np.sin(yaw)
    return np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])


def is_bounded(matrix: Floats) -> bool:
    """Return true if a matrix has only numbers that can be variances of positions on Earth; they do not overflow."""
    return bool((np.abs(matrix) <= FARTHEST_M**2).all())


def is_covariance(matrix: Floats) -> bool:
    """Return true if a symmetric matrix is bounded and positive definite, so that no error is impossible."""
    return is_bounded(matrix) and bool((np.linalg.eigvalsh(matrix) > 0).all())


def squared_distance(one: PlanarGaussian, other: PlanarGaussian) -> float:
    """Return the squared difference of two poses over the sum of their covariances.

    It is chi squared with 3 degrees of freedom if both are estimates of the same pose, with independent errors. The
    directions may differ by any angle, if one of them is not known.
    """
    apart = one.pose.inverse() @ other.pose
    turned = rotation(apart.yaw)
    missed = np.array([apart.x, apart.y, math.remainder(apart.yaw, 2 * math.pi)])
    return float(missed @ np.linalg.solve(one.covariance + turned @ other.covariance @ turned.T, missed))


def squared_way(one: PlanarGaussian, other: PlanarGaussian) -> float:
    """Return the same for the positions alone; it is chi squared with 2 degrees of freedom."""
    way = np.array([other.pose.x - one.pose.x, other.pose.y - one.pose.y])
    return float(way @ np.linalg.solve((one.outer_covariance + other.outer_covariance)[:2, :2], way))
