"""Quaternions and angles: about the fixed axes x, y and z in this order, in radians, as REP-103 has them."""

from __future__ import annotations

from math import asin, atan2, copysign, cos, pi, sin
from typing import Protocol


class Quaternion(Protocol):
    """What has the four parts of a quaternion."""

    x: float
    y: float
    z: float
    w: float


def quaternion(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    """The parts x, y, z and w of a rotation."""
    sin_roll, cos_roll = sin(roll * 0.5), cos(roll * 0.5)
    sin_pitch, cos_pitch = sin(pitch * 0.5), cos(pitch * 0.5)
    sin_yaw, cos_yaw = sin(yaw * 0.5), cos(yaw * 0.5)
    both_cos, both_sin = cos_roll * cos_pitch, sin_roll * sin_pitch
    rolled, pitched = sin_roll * cos_pitch, cos_roll * sin_pitch
    return (
        rolled * cos_yaw - pitched * sin_yaw,
        pitched * cos_yaw + rolled * sin_yaw,
        both_cos * sin_yaw - both_sin * cos_yaw,
        both_cos * cos_yaw + both_sin * sin_yaw,
    )


def angles(rotation: Quaternion) -> tuple[float, float, float]:
    """Roll, pitch and yaw of a rotation; straight up or down, where roll and yaw are one turn, it is all yaw.

    A quaternion of any length but zero is taken for the one of length 1; of zero, as a new message of some ROS has
    it, every angle is zero.
    """
    x, y, z, w = rotation.x, rotation.y, rotation.z, rotation.w
    square = x * x + y * y + z * z + w * w
    if not square:
        return 0.0, 0.0, 0.0
    sine = 2 * (w * y - z * x) / square
    if abs(sine) >= _STRAIGHT:
        return 0.0, copysign(pi / 2, sine), 2 * atan2(z, w)
    roll = atan2(2 * (w * x + y * z), w * w - x * x - y * y + z * z)
    return roll, asin(sine), atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z)


_STRAIGHT = 1 - 1e-15
"""A sine of the pitch at which the other two angles cannot be told apart."""
