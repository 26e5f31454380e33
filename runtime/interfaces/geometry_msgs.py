"""Messages of the ROS 2 package geometry_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Annotated, ClassVar

from roverlink.runtime.core.messages import Float64, Length, Message
from roverlink.runtime.interfaces import std_msgs


@dataclass(slots=True)
class Vector3(Message):
    """ROS 2 message geometry_msgs/msg/Vector3."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Vector3"

    x: Float64 = 0.0
    y: Float64 = 0.0
    z: Float64 = 0.0


@dataclass(slots=True)
class Point(Message):
    """ROS 2 message geometry_msgs/msg/Point."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Point"

    x: Float64 = 0.0
    y: Float64 = 0.0
    z: Float64 = 0.0


@dataclass(slots=True)
class Quaternion(Message):
    """ROS 2 message geometry_msgs/msg/Quaternion."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Quaternion"

    x: Float64 = 0.0
    y: Float64 = 0.0
    z: Float64 = 0.0
    w: Float64 = 1.0


@dataclass(slots=True)
class Transform(Message):
    """ROS 2 message geometry_msgs/msg/Transform."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Transform"

    translation: Vector3 = dataclasses.field(default_factory=Vector3)
    rotation: Quaternion = dataclasses.field(default_factory=Quaternion)


@dataclass(slots=True)
class TransformStamped(Message):
    """ROS 2 message geometry_msgs/msg/TransformStamped."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/TransformStamped"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    child_frame_id: str = ""
    transform: Transform = dataclasses.field(default_factory=Transform)


@dataclass(slots=True)
class Pose(Message):
    """ROS 2 message geometry_msgs/msg/Pose."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Pose"

    position: Point = dataclasses.field(default_factory=Point)
    orientation: Quaternion = dataclasses.field(default_factory=Quaternion)


@dataclass(slots=True)
class PoseStamped(Message):
    """ROS 2 message geometry_msgs/msg/PoseStamped."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/PoseStamped"
    __typehash__: ClassVar[str] = "RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    pose: Pose = dataclasses.field(default_factory=Pose)


@dataclass(slots=True)
class PoseWithCovariance(Message):
    """ROS 2 message geometry_msgs/msg/PoseWithCovariance."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/PoseWithCovariance"

    pose: Pose = dataclasses.field(default_factory=Pose)
    covariance: Annotated[list[Float64], Length(36)] = dataclasses.field(default_factory=lambda: [0.0] * 36)


@dataclass(slots=True)
class PoseWithCovarianceStamped(Message):
    """ROS 2 message geometry_msgs/msg/PoseWithCovarianceStamped."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/PoseWithCovarianceStamped"
    __typehash__: ClassVar[str] = "RIHS01_26432f9803e43727d3c8f668d1fdb3c630f548af631e2f4e31382371bfea3b6e"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    pose: PoseWithCovariance = dataclasses.field(default_factory=PoseWithCovariance)


@dataclass(slots=True)
class Twist(Message):
    """ROS 2 message geometry_msgs/msg/Twist."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Twist"

    linear: Vector3 = dataclasses.field(default_factory=Vector3)
    angular: Vector3 = dataclasses.field(default_factory=Vector3)


@dataclass(slots=True)
class TwistStamped(Message):
    """ROS 2 message geometry_msgs/msg/TwistStamped."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/TwistStamped"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    twist: Twist = dataclasses.field(default_factory=Twist)


@dataclass(slots=True)
class TwistWithCovariance(Message):
    """ROS 2 message geometry_msgs/msg/TwistWithCovariance."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/TwistWithCovariance"

    twist: Twist = dataclasses.field(default_factory=Twist)
    covariance: Annotated[list[Float64], Length(36)] = dataclasses.field(default_factory=lambda: [0.0] * 36)
