# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Messages of the ROS 2 package geometry_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.interfaces import std_msgs
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces.geometry_msgs import Point, Pose, Quaternion

__all__ = [
    "Point",
    "Pose",
    "PoseStamped",
    "Quaternion",
    "QuaternionStamped",
]


@dataclass(slots=True)
class PoseStamped(Message):
    """geometry_msgs/msg/PoseStamped."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/PoseStamped"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    pose: Pose = dataclasses.field(default_factory=Pose)


@dataclass(slots=True)
class QuaternionStamped(Message):
    """geometry_msgs/msg/QuaternionStamped."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/QuaternionStamped"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    quaternion: Quaternion = dataclasses.field(default_factory=Quaternion)
