# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Messages of the ROS 2 package geometry_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.interfaces import std_msgs
from runtime.messages import Float64, Message


@dataclass(slots=True)
class Point(Message):
    """geometry_msgs/msg/Point."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Point"

    x: Float64 = 0.0
    y: Float64 = 0.0
    z: Float64 = 0.0


@dataclass(slots=True)
class Quaternion(Message):
    """geometry_msgs/msg/Quaternion."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Quaternion"

    x: Float64 = 0.0
    y: Float64 = 0.0
    z: Float64 = 0.0
    w: Float64 = 1.0


@dataclass(slots=True)
class Pose(Message):
    """geometry_msgs/msg/Pose."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Pose"

    position: Point = dataclasses.field(default_factory=Point)
    orientation: Quaternion = dataclasses.field(default_factory=Quaternion)


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
