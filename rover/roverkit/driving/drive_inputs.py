"""Messages that ``roverlink drive`` receives: conversion, and the check that they can be used.

Every function raises `ConversionError` if a message is damaged, or cannot be used. The texts have no values that change
from message to message, so that the user reads them once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from roverkit.driving.arcs import PlanarPose
from roverkit.driving.path_following import Point
from roverlink.runtime.convert.rotations import angles
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces.geometry_msgs import Twist, TwistStamped
from roverlink.runtime.interfaces.nav_msgs import Odometry, Path
from roverlink.runtime.interfaces.std_msgs import Header
from roverlink.runtime.ros_time.headers import stamp_of

OLDEST_PATH_S = 10.0
"""Age in seconds from which a path is not followed. A planner may need some seconds after the stamp of its path."""


@dataclass(frozen=True, slots=True)
class ReceivedPose:
    """Pose of the rover from a nav_msgs/Odometry."""

    pose: PlanarPose
    frame: str
    age: int
    """Age in nanoseconds."""
    deviation: float
    """Standard deviation of the position on the plane in metres, in the direction in which it is largest."""
    speed: float | None
    """Speed in m/s along x; None if its variance is 0, as that of a speed that is not measured."""


def velocity_of(kind: type[Message], data: bytes, now: int, longest: float, base_frame: str) -> tuple[float, float]:
    """Return the speed along x in m/s and the angular velocity about z in rad/s of a serialized velocity.

    ``now`` is the time in nanoseconds, ``longest`` the largest age in seconds of a message with a stamp.
    """
    if kind is TwistStamped:
        message = cdr.decode(TwistStamped, data)
        if message.header.frame_id not in ("", base_frame):
            raise ConversionError(f"it is in the frame {message.header.frame_id!r}, not in {base_frame!r}")
        _check_age(message.header, now, longest)
        twist = message.twist
    else:
        twist = cdr.decode(Twist, data)
    return twist.linear.x, twist.angular.z


def path_of(data: bytes, now: int) -> tuple[list[Point], str]:
    """Return the points of a serialized path, in metres, and their frame. ``now`` is the time in nanoseconds."""
    path = cdr.decode(Path, data)
    frame = path.header.frame_id
    others = {pose.header.frame_id for pose in path.poses} - {"", frame}
    if others:
        raise ConversionError(f"it is in the frame {frame!r}, but has poses in {sorted(others)}")
    _check_age(path.header, now, OLDEST_PATH_S)
    return [(pose.pose.position.x, pose.pose.position.y) for pose in path.poses], frame


def pose_of(data: bytes, now: int, longest: float, base_frame: str) -> ReceivedPose:
    """Return the pose of the rover from a serialized odometry.

    ``now`` is the time in nanoseconds. A pose may be of any age, but not more than ``longest`` seconds in the future.
    """
    message = cdr.decode(Odometry, data)
    if message.child_frame_id not in ("", base_frame):
        raise ConversionError(f"it is the pose of {message.child_frame_id!r}, not of {base_frame!r}")
    stamp = stamp_of(message.header)
    if stamp == 0:
        raise ConversionError("it has no stamp")
    if now - stamp < -longest * 1e9:
        raise ConversionError("its stamp is in the future; is the clock of its computer right?")
    place, covariance = message.pose.pose, message.pose.covariance
    yaw = angles(place.orientation)[2]
    # The larger eigenvalue of the covariance of x and y.
    half, cross = (covariance[0] - covariance[7]) / 2, covariance[1]
    variance = (covariance[0] + covariance[7]) / 2 + math.hypot(half, cross)
    speed, of_speed = message.twist.twist.linear.x, message.twist.covariance[0]
    pose = PlanarPose(place.position.x, place.position.y, yaw)
    if not pose.is_on_earth or not all(map(math.isfinite, (variance, speed, of_speed))):
        raise ConversionError("it has a value that is not a number, or not on Earth")
    return ReceivedPose(
        pose,
        message.header.frame_id,
        now - stamp,
        math.sqrt(max(variance, 0.0)),
        speed if of_speed > 0 else None,
    )


def _check_age(header: Header, now: int, longest: float) -> None:
    """Raise `ConversionError` if a message with a stamp is older than some seconds, or that far in the future."""
    stamp = stamp_of(header)
    if stamp and abs(now - stamp) > longest * 1e9:
        when = "in the future" if stamp > now else f"more than {longest:g} s old"
        raise ConversionError(f"its stamp is {when}; is the clock of its computer right?")
