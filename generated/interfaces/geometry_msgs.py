# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Messages of the ROS 2 package geometry_msgs."""

from __future__ import annotations

from roverlink.runtime.interfaces.geometry_msgs import (
    Point,
    Pose,
    PoseWithCovariance,
    Quaternion,
    Twist,
    TwistWithCovariance,
    Vector3,
)

__all__ = [
    "Point",
    "Pose",
    "PoseWithCovariance",
    "Quaternion",
    "Twist",
    "TwistWithCovariance",
    "Vector3",
]
