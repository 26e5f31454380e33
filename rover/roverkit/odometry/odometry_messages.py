"""Messages with a pose and a velocity on a plane."""

from __future__ import annotations

from roverkit.driving.arcs import PlanarPose
from roverkit.odometry.wheel_odometry import OdometryEstimate
from roverlink.runtime.convert.rotations import quaternion
from roverlink.runtime.interfaces import geometry_msgs
from roverlink.runtime.interfaces.nav_msgs import Odometry
from roverlink.runtime.interfaces.std_msgs import Header

UNKNOWN_VARIANCE = 1e6
"""Variance of what is not measured: height, roll and pitch, and the velocities along and about these axes."""
_PLANE = (0, 1, 5)
"""Indices of x, y and yaw in a pose with six entries."""


def odometry_of(estimate: OdometryEstimate, header: Header, base_frame: str) -> Odometry:
    """Return the message of an estimate. Its pose is in the frame of the header, its velocity in ``base_frame``."""
    pose, twist = _unknown(), _unknown()
    for row, values in zip(_PLANE, estimate.covariance):
        for column, value in zip(_PLANE, values):
            pose[6 * row + column] = value
    # A rover with wheels does not drive sideways, but it slips: the same part of the speed as forwards.
    twist[0] = twist[7] = estimate.speed_variance
    twist[35] = estimate.yaw_rate_variance
    velocity = geometry_msgs.Twist(
        geometry_msgs.Vector3(estimate.speed), geometry_msgs.Vector3(0.0, 0.0, estimate.yaw_rate)
    )
    return Odometry(
        header,
        base_frame,
        geometry_msgs.PoseWithCovariance(pose_of(estimate.pose), pose),
        geometry_msgs.TwistWithCovariance(velocity, twist),
    )


def pose_of(pose: PlanarPose) -> geometry_msgs.Pose:
    """Return the message of a pose on the plane z = 0."""
    return geometry_msgs.Pose(
        geometry_msgs.Point(pose.x, pose.y), geometry_msgs.Quaternion(*quaternion(0.0, 0.0, pose.yaw))
    )


def transform_of(odometry: Odometry) -> geometry_msgs.TransformStamped:
    """Return the transform to the frame of the pose from the frame of the rover."""
    position, orientation = odometry.pose.pose.position, odometry.pose.pose.orientation
    transform = geometry_msgs.Transform(geometry_msgs.Vector3(position.x, position.y, position.z), orientation)
    return geometry_msgs.TransformStamped(odometry.header, odometry.child_frame_id, transform)


def _unknown() -> list[float]:
    """Return a covariance (6, 6), row by row, in which nothing is known."""
    return [UNKNOWN_VARIANCE if index % 7 == 0 else 0.0 for index in range(36)]
