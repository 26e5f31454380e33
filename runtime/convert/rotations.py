"""Conversion between quaternions and Euler angles in radians.

Euler angles are roll, pitch and yaw about the fixed axes x, y and z, applied in this order (REP 103).
"""

from __future__ import annotations

from math import asin, atan2, copysign, cos, pi, sin
from typing import Protocol


class Quaternion(Protocol):
    """Object with the four components of a quaternion, such as a geometry_msgs/Quaternion."""

    x: float
    y: float
    z: float
    w: float


def quaternion(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    """Return the components x, y, z, w of the quaternion for a roll, pitch and yaw in radians."""
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
    """Return roll, pitch and yaw of a quaternion, in radians.

    At a pitch of +-90 degrees only the sum or the difference of roll and yaw is defined (gimbal lock); the result then
    has a roll of 0, and the whole rotation is in yaw. The quaternion need not have the length 1. For a quaternion of
    zeros, which is the default of a new message in some ROS libraries, every angle is 0.
    """
    x, y, z, w = rotation.x, rotation.y, rotation.z, rotation.w
    # The formulas divide by the squared length instead of normalizing first, which avoids a square root.
    square = x * x + y * y + z * z + w * w
    if not square:
        return 0.0, 0.0, 0.0
    sine = 2 * (w * y - z * x) / square
    # With roll 0 and pitch 90 degrees, w is cos(yaw / 2) and z is sin(yaw / 2), both times sqrt(1/2).
    if abs(sine) >= _STRAIGHT:
        return 0.0, copysign(pi / 2, sine), 2 * atan2(z, w)
    roll = atan2(2 * (w * x + y * z), w * w - x * x - y * y + z * z)
    return roll, asin(sine), atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z)


_STRAIGHT = 1 - 1e-15
"""Sine of the pitch from which roll and yaw cannot be told apart in double precision."""
