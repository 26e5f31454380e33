"""Poses (transforms from one frame to another), and the rays along which a camera sees points.

The error of a pose is (dx, dy, dz, rx, ry, rz): the true translation is t + d, the true rotation is exp([r]x) R. d and
r are in the axes of the frame in which the pose is given, as in ROS 2's `PoseWithCovariance`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.opencv import cv2

# Near 180 degrees the antisymmetric part of the matrix vanishes, and with it the direction of the axis.
_HALF_TURN = -0.99  # cosine of an angle near 180 degrees
_TINY = 1e-150  # smallest half angle; it avoids 0 / 0 in sin(x) / x
_CROSS = np.zeros((3, 9))  # maps a vector to its cross product matrix, row by row
_CROSS[0, [5, 7]], _CROSS[1, [2, 6]], _CROSS[2, [1, 3]] = (-1, 1), (1, -1), (-1, 1)


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """Transform of points from one frame to another: `rotation` (3, 3) @ point + `translation` (3,), in metres."""

    rotation: Floats
    translation: Floats

    def apply(self, points: Floats) -> Floats:
        """Transform points (..., 3) to the other frame."""
        moved: Floats = points @ self.rotation.T + self.translation
        return moved

    def __matmul__(self, first: Pose) -> Pose:
        return Pose(self.rotation @ first.rotation, self.rotation @ first.translation + self.translation)

    def inverse(self) -> Pose:
        """Return the transform in the opposite direction."""
        return Pose(self.rotation.T, -self.rotation.T @ self.translation)

    def moved(self, change: Floats) -> Pose:
        """Return the pose that results from a change (6,): x y z in metres, rotX rotY rotZ in radians."""
        return Pose(rotation_of(change[3:]) @ self.rotation, self.translation + change[:3])

    def change_to(self, other: Pose) -> Floats:
        """Return the change (6,) that turns this pose into another one; `moved` applies it."""
        return np.concatenate([other.translation - self.translation, angles_of(other.rotation @ self.rotation.T)])

    def angle_to(self, other: Pose) -> float:
        """Return the angle in radians between the rotations of this pose and another one.

        The Frobenius norm of the difference of two rotation matrices is sqrt(8) sin(angle / 2).
        """
        apart = other.rotation - self.rotation
        return 2 * math.asin(min(math.sqrt(float(np.vdot(apart, apart)) / 8), 1.0))


IDENTITY = Pose(np.eye(3), np.zeros(3))
"""Transform that changes nothing."""


def rotation_of(angles: Floats) -> Floats:
    """Return the rotations (..., 3, 3) about axes (..., 3), whose lengths are the angles in radians (Rodrigues)."""
    axes = np.asarray(angles, dtype=float)
    half = np.maximum(np.sqrt((axes * axes).sum(axis=-1)) / 2, _TINY)[..., None, None]
    cross = (axes @ _CROSS).reshape(*axes.shape, 3)
    rotation: Floats = (
        np.eye(3) + np.sin(2 * half) / (2 * half) * cross + (np.sin(half) / half) ** 2 / 2 * (cross @ cross)
    )
    return rotation


def angles_of(rotation: Floats) -> Floats:
    """Return the rotation vector (3,) of a rotation (3, 3). This is the inverse of `rotation_of`.

    The vector is computed from the sine of the angle, which is inaccurate near 180 degrees. There, and only there,
    OpenCV's Rodrigues is used, because it treats angles below 1e-5 as zero.
    """
    (_, a, b), (c, _, d), (e, f, _) = rotation.tolist()
    sine = math.sqrt((f - d) ** 2 + (b - e) ** 2 + (c - a) ** 2) / 2
    cosine = (float(rotation.trace()) - 1) / 2
    if cosine < _HALF_TURN:
        angles: Floats = cv2.Rodrigues(rotation)[0].ravel()
        return angles
    factor = math.atan2(sine, cosine) / sine / 2 if sine else 0.5
    return np.array([f - d, b - e, c - a]) * factor


def rotation_of_quaternion(quaternion: Floats) -> Floats:
    """Return the rotation (3, 3) of a quaternion x y z w of any length. This is the inverse of `quaternion_of`."""
    x, y, z, w = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion_of(rotation: Floats) -> Floats:
    """Return the unit quaternion x y z w of a rotation (3, 3); w is never negative."""
    angles = angles_of(rotation)
    half = float(np.linalg.norm(angles)) / 2
    return np.append(
        angles / 2 * np.sinc(half / np.pi), max(math.cos(half), 0.0)
    )  # rounding can make the cosine of 90 degrees negative


def predict(pose: Pose, points: Floats) -> tuple[Floats, Floats]:
    """Return the rays (N, 2) at which a camera sees points (N, 3), and the derivative (N, 2, 6) of the rays.

    `pose` transforms the points to the camera's frame; the derivative is with respect to it: x y z rotX rotY rotZ. A
    ray is a point (x, y) in the plane z = 1. The values of points behind the camera are NaN.
    """
    return predict_all(pose.rotation, pose.translation, points)


def predict_all(rotation: Floats, translation: Floats, points: Floats) -> tuple[Floats, Floats]:
    """Return the same as `predict` for many poses at once.

    The arrays have more dimensions: rotations (..., 3, 3), translations (..., 3), points (..., N, 3).
    """
    turned = points @ np.swapaxes(rotation, -1, -2)
    seen = turned + translation[..., None, :]
    z = np.where(seen[..., 2] > 0, seen[..., 2], np.nan)[..., None]
    rays = seen[..., :2] / z
    u, v, x, y, depth = rays[..., 0], rays[..., 1], turned[..., 0], turned[..., 1], turned[..., 2]
    derivative = np.zeros((*rays.shape, 6))
    derivative[..., 0, 0] = derivative[..., 1, 1] = 1
    derivative[..., :, 2] = -rays
    # a small rotation r moves a point by the cross product of r and `turned`
    derivative[..., 0, 3], derivative[..., 0, 4], derivative[..., 0, 5] = -u * y, depth + u * x, -y
    derivative[..., 1, 3], derivative[..., 1, 4], derivative[..., 1, 5] = -depth - v * y, v * x, x
    return rays, derivative / z[..., None]
