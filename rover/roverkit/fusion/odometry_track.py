"""Odometry of the last seconds: the rover's pose at the time of an image, and its motion between two images."""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass, replace
from operator import attrgetter

import numpy as np

from roverkit.driving.arcs import FARTHEST_M, PlanarPose
from roverkit.fusion.planar_gaussian import Floats, is_bounded, rotation
from roverkit.fusion.slipping_motion import SlippingMotion, YawError, slipping_motion, turn_lever
from roverkit.odometry.dead_reckoning import OdometryNoise
from roverkit.odometry.odometry_messages import UNKNOWN_VARIANCE
from roverkit.odometry.wheel_odometry import SPEED_DEVIATION
from roverlink.runtime.convert.rotations import angles
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.interfaces.nav_msgs import Odometry
from roverlink.runtime.ros_time.headers import stamp_of

PLANAR = np.ix_([0, 1, 5], [0, 1, 5])
"""Rows and columns of x, y and yaw in a covariance of a message."""
_SLOWEST = 1e-3
"""Speed in m/s below which a rover stands, and no part of the speed is slip."""
_UNCORRELATED = 1e-9
"""Correlation of errors of which one is exactly 0."""
KEPT_NS = 10_000_000_000
"""Time in nanoseconds for which odometry is kept."""
_FASTEST = 5.0
"""Speed in m/s beyond that of the message, and angular velocity in rad/s, that no rover reaches."""


@dataclass(frozen=True, slots=True, eq=False)
class OdometryPoint:
    """Pose by odometry at a time."""

    stamp: int
    """Time in nanoseconds."""
    pose: PlanarPose
    """Pose of the rover in the frame of the odometry."""
    covariance: Floats
    """Covariance (3, 3) of the pose in the axes of that frame, as in the message."""
    yaw_rate_variance: float
    """Variance of the angular velocity since the point before, in (rad/s)^2."""
    forgotten: float = 0.0
    """Negative logarithm of the correlation of the yaw's error with that of the track's begin; the track sets it."""
    slip: float = math.nan
    """Variance of the relative error of the speed; not a number if it is not known."""
    mean_slip: float = 0.0
    """Standard deviation of the mean of this error, which stays the same; the track sets it."""
    slipped: tuple[float, float] = (0.0, 0.0)
    """Variances of the distance and of the motion sideways since the track began, in m^2; the track sets them."""
    speed: float = 0.0
    """Speed in m/s, negative backwards."""

    def motion_to(self, later: OdometryPoint) -> SlippingMotion:
        """Return the motion from this point to a later one of the same track.

        The covariance of the odometry grows by that of the motion, after the error of the yaw before the motion has
        turned the motion. Hence the part of the later covariance that does not follow from the earlier one is that of
        the motion. This is wrong for errors that stay the same, such as the mean slip. Hence the variance of the
        distance is that of the speed, if the message has one.
        """
        moved = self.pose.inverse() @ later.pose
        mean_slip = 0.0
        if math.isnan(later.slip):
            lever = turn_lever(moved)
            growth = _growth(self, later)
            slipped = (growth - growth[2, 2] * np.outer(lever, lever))[:2, :2]
        else:
            slipped = np.diag(np.subtract(later.slipped, self.slipped))
            mean_slip = later.mean_slip
        before, after = (math.sqrt(max(point.covariance[2, 2], 0.0)) for point in (self, later))
        yaw = YawError(before, after, math.exp(self.forgotten - later.forgotten))
        return slipping_motion(moved, slipped, yaw, mean_slip)


def _growth(before: OdometryPoint, after: OdometryPoint) -> Floats:
    """Return the part (3, 3) of the later covariance that does not follow from the earlier one, in the later axes."""
    turned = np.eye(3)
    turned[0, 2], turned[1, 2] = before.pose.y - after.pose.y, after.pose.x - before.pose.x
    grown = after.covariance - turned @ before.covariance @ turned.T
    growth: Floats = rotation(after.pose.yaw).T @ grown @ rotation(after.pose.yaw)
    return growth


def _correlation(before: OdometryPoint, after: OdometryPoint) -> float:
    """Return the correlation of the errors of the yaw at two successive points, by the law of cosines.

    The variances of both errors are those of the messages. That of their difference follows from the variance of the
    angular velocity. It is at most the change of the variance, which is that of independent errors.
    """
    first, second = (float(point.covariance[2, 2]) for point in (before, after))
    turned = after.yaw_rate_variance * ((after.stamp - before.stamp) / 1e9) ** 2
    both = 2 * math.sqrt(max(first * second, 0.0))
    if not both:
        return _UNCORRELATED
    return min(max((first + second - min(turned, abs(second - first))) / both, _UNCORRELATED), 1.0)


class OdometryTrack:
    """Odometry of the last seconds."""

    def __init__(self, mean_slip: float) -> None:
        """Begin without a point. ``mean_slip`` is the standard deviation of the mean slip, as a part of the way."""
        self._mean_slip = mean_slip
        self._points: list[OdometryPoint] = []

    @property
    def newest(self) -> OdometryPoint | None:
        """Newest point."""
        return self._points[-1] if self._points else None

    def add(self, point: OdometryPoint) -> bool:
        """Add a point, and return true; return false if the odometry has begun again, which leaves only this point.

        It has if the time jumps back, or the pose jumps.
        """
        newest = self.newest
        if newest is not None and newest.stamp - KEPT_NS < point.stamp <= newest.stamp:
            return True  # repeated or overtaken on the way
        if newest is not None and (point.stamp < newest.stamp or _is_jump(newest, point)):
            self._points = [point]
            return False
        if newest is not None:
            distance = newest.pose.distance_to(point.pose)
            slip = newest.slip if math.isnan(point.slip) else point.slip
            ahead, aside = newest.slipped
            point = replace(
                point,
                slip=slip,
                mean_slip=self._mean_slip,
                forgotten=newest.forgotten - math.log(_correlation(newest, point)),
                slipped=(
                    ahead + (0.0 if math.isnan(slip) else slip * distance),
                    aside + float(_growth(newest, point)[1, 1]),
                ),
            )
        self._points.append(point)
        del self._points[: bisect_left(self._points, point.stamp - KEPT_NS, key=attrgetter("stamp"))]
        return True

    def at(self, stamp: int) -> OdometryPoint | None:
        """Return the point at a time in nanoseconds, interpolated; None if no odometry surrounds that time."""
        place = bisect_left(self._points, stamp, key=attrgetter("stamp"))
        if place == len(self._points):
            return None
        after = self._points[place]
        if after.stamp == stamp:
            return after
        if place == 0:
            return None
        before = self._points[place - 1]
        part = (stamp - before.stamp) / (after.stamp - before.stamp)
        turn = math.remainder(after.pose.yaw - before.pose.yaw, 2 * math.pi)
        pose = PlanarPose(
            before.pose.x + part * (after.pose.x - before.pose.x),
            before.pose.y + part * (after.pose.y - before.pose.y),
            before.pose.yaw + part * turn,
        )
        return replace(
            after,
            stamp=stamp,
            pose=pose,
            covariance=before.covariance + part * (after.covariance - before.covariance),
            forgotten=before.forgotten + part * (after.forgotten - before.forgotten),
            slipped=tuple((1 - part) * np.array(before.slipped) + part * np.array(after.slipped)),
        )


def _is_jump(before: OdometryPoint, after: OdometryPoint) -> bool:
    """Return true if the rover cannot have moved from one pose to the other: the odometry was started again."""
    seconds = (after.stamp - before.stamp) / 1e9
    turn = math.remainder(after.pose.yaw - before.pose.yaw, 2 * math.pi)
    farthest = (_FASTEST + max(abs(before.speed), abs(after.speed))) * seconds
    return before.pose.distance_to(after.pose) > farthest or abs(turn) > _FASTEST * seconds


class UnknownCovariance:
    """Covariance of odometry whose messages have none: that of wheel odometry without an IMU (`OdometryNoise`)."""

    def __init__(self, pose: PlanarPose) -> None:
        """Begin at a pose."""
        self._pose, self._covariance = pose, np.zeros((3, 3))

    def at(self, pose: PlanarPose) -> Floats:
        """Return the covariance (3, 3) at the next pose, in the axes of the frame of the odometry."""
        noise, motion = OdometryNoise(), self._pose.inverse() @ pose
        distance, turn = math.hypot(motion.x, motion.y), math.remainder(motion.yaw, 2 * math.pi)
        own = np.diag([noise.slip**2, noise.side_slip**2, noise.yaw_slip**2]) * distance
        own[2, 2] += (noise.slip * turn) ** 2
        carried = np.eye(3)
        carried[0, 2], carried[1, 2] = self._pose.y - pose.y, pose.x - self._pose.x
        turned = rotation(pose.yaw)
        self._pose, self._covariance = pose, carried @ self._covariance @ carried.T + turned @ own @ turned.T
        return self._covariance


def point_of(message: Odometry) -> OdometryPoint:
    """Return the odometry of a message. Raises `ConversionError` if it has no usable pose or covariance.

    By ROS 2's convention, a variance of 0 is unknown.
    """
    place = message.pose.pose
    covariance = np.reshape(message.pose.covariance, (6, 6))[PLANAR]
    turning = message.twist.covariance[-1] or UNKNOWN_VARIANCE
    pose = PlanarPose(place.position.x, place.position.y, angles(place.orientation)[2])
    if not (pose.is_on_earth and is_bounded(covariance) and 0 <= turning < math.inf and stamp_of(message.header)):
        raise ConversionError("it has no stamp, or a value that is not a number, or not on Earth")
    speed, of_speed = message.twist.twist.linear.x, message.twist.covariance[0] - SPEED_DEVIATION**2
    speed = speed if abs(speed) < FARTHEST_M else 0.0
    slip = of_speed / speed**2 if abs(speed) > _SLOWEST and 0 < of_speed < math.inf else math.nan
    return OdometryPoint(stamp_of(message.header), pose, covariance, turning, slip=slip, speed=speed)
