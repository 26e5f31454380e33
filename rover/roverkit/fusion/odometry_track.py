"""Odometry of the last seconds: the rover's pose at the time of an image, and its motion between two images."""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass, replace
from operator import attrgetter

import numpy as np

from roverkit.driving.arcs import PlanarPose
from roverkit.fusion.planar_gaussian import Floats, rotation
from roverkit.fusion.slipping_motion import SlippingMotion, slipping_motion

KEPT_NS = 10_000_000_000
"""Time in nanoseconds for which odometry is kept."""
_FASTEST = 5.0
"""Speed in m/s, and angular velocity in rad/s, that no rover reaches."""


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
    rolled: float = 0.0
    """Distance in metres that the rover has driven since the track began; the track sets it."""
    turn_deviation: float = 0.0
    """Integral of the angular velocity's standard deviation since the track began, in radians; the track sets it."""

    def motion_to(self, later: OdometryPoint) -> SlippingMotion:
        """Return the motion from this point to a later one of the same track.

        The covariance of the odometry grows by that of the motion, after the error of the yaw before the motion has
        turned the motion. Hence the part of the later covariance that does not follow from the earlier one is that of
        the motion.

        For the yaw, this is too much if the gyroscope has a bias: the error of the motion is correlated with the one
        before it, so the variance of the sum grows faster and faster. But the error of the turn is no larger than the
        integral of that of the angular velocity.
        """
        turned = np.eye(3)
        turned[0, 2], turned[1, 2] = self.pose.y - later.pose.y, later.pose.x - self.pose.x
        grown = later.covariance - turned @ self.covariance @ turned.T
        own = rotation(later.pose.yaw).T @ grown @ rotation(later.pose.yaw)
        most = later.turn_deviation - self.turn_deviation
        if own[2, 2] > most**2:
            narrowed = np.diag([1, 1, most / math.sqrt(own[2, 2])])
            own = narrowed @ own @ narrowed
        return slipping_motion(self.pose.inverse() @ later.pose, own, later.rolled - self.rolled)


class OdometryTrack:
    """Odometry of the last seconds."""

    def __init__(self) -> None:
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
            deviation = math.sqrt(point.yaw_rate_variance) * (point.stamp - newest.stamp) / 1e9
            rolled = newest.rolled + newest.pose.distance_to(point.pose)
            point = replace(point, rolled=rolled, turn_deviation=newest.turn_deviation + deviation)
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
        return OdometryPoint(
            stamp,
            pose,
            before.covariance + part * (after.covariance - before.covariance),
            after.yaw_rate_variance,
            before.rolled + part * (after.rolled - before.rolled),
            before.turn_deviation + part * (after.turn_deviation - before.turn_deviation),
        )


def _is_jump(before: OdometryPoint, after: OdometryPoint) -> bool:
    """Return true if the rover cannot have moved from one pose to the other: the odometry was started again."""
    farthest = _FASTEST * (after.stamp - before.stamp) / 1e9
    turn = math.remainder(after.pose.yaw - before.pose.yaw, 2 * math.pi)
    return before.pose.distance_to(after.pose) > farthest or abs(turn) > farthest
