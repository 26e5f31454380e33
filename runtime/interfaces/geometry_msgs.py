# Generated from the definitions of ROS 2; do not edit.
# Regenerate with: make generate
"""Messages of the ROS 2 package geometry_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Annotated, ClassVar

from roverlink.runtime.core.messages import Float64, Length, Message
from roverlink.runtime.interfaces import std_msgs


@dataclass(slots=True)
class Point(Message):
    """geometry_msgs/msg/Point."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Point"
    __typehash__: ClassVar[str] = "RIHS01_6963084842a9b04494d6b2941d11444708d892da2f4b09843b9c43f42a7f6881"

    x: Float64 = 0.0
    y: Float64 = 0.0
    z: Float64 = 0.0


@dataclass(slots=True)
class Quaternion(Message):
    """geometry_msgs/msg/Quaternion."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Quaternion"
    __typehash__: ClassVar[str] = "RIHS01_8a765f66778c8ff7c8ab94afcc590a2ed5325a1d9a076ffff38fbce36f458684"

    x: Float64 = 0.0
    y: Float64 = 0.0
    z: Float64 = 0.0
    w: Float64 = 1.0


@dataclass(slots=True)
class Pose(Message):
    """geometry_msgs/msg/Pose."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Pose"
    __typehash__: ClassVar[str] = "RIHS01_d501954e9476cea2996984e812054b68026ae0bfae789d9a10b23daf35cc90fa"

    position: Point = dataclasses.field(default_factory=Point)
    orientation: Quaternion = dataclasses.field(default_factory=Quaternion)


@dataclass(slots=True)
class PoseStamped(Message):
    """geometry_msgs/msg/PoseStamped."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/PoseStamped"
    __typehash__: ClassVar[str] = "RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    pose: Pose = dataclasses.field(default_factory=Pose)


@dataclass(slots=True)
class PoseWithCovariance(Message):
    """geometry_msgs/msg/PoseWithCovariance."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/PoseWithCovariance"
    __typehash__: ClassVar[str] = "RIHS01_9a7c0fd234b7f45c6098745ecccd773ca1085670e64107135397aee31c02e1bb"

    pose: Pose = dataclasses.field(default_factory=Pose)
    covariance: Annotated[list[Float64], Length(36)] = dataclasses.field(default_factory=lambda: [0.0] * 36)


@dataclass(slots=True)
class PoseWithCovarianceStamped(Message):
    """geometry_msgs/msg/PoseWithCovarianceStamped."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/PoseWithCovarianceStamped"
    __typehash__: ClassVar[str] = "RIHS01_26432f9803e43727d3c8f668d1fdb3c630f548af631e2f4e31382371bfea3b6e"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    pose: PoseWithCovariance = dataclasses.field(default_factory=PoseWithCovariance)


@dataclass(slots=True)
class Vector3(Message):
    """geometry_msgs/msg/Vector3."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Vector3"
    __typehash__: ClassVar[str] = "RIHS01_cc12fe83e4c02719f1ce8070bfd14aecd40f75a96696a67a2a1f37f7dbb0765d"

    x: Float64 = 0.0
    y: Float64 = 0.0
    z: Float64 = 0.0


@dataclass(slots=True)
class Transform(Message):
    """geometry_msgs/msg/Transform."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Transform"
    __typehash__: ClassVar[str] = "RIHS01_beb83fbe698636351461f6f35d1abb20010c43d55374d81bd041f1ba2581fddc"

    translation: Vector3 = dataclasses.field(default_factory=Vector3)
    rotation: Quaternion = dataclasses.field(default_factory=Quaternion)


@dataclass(slots=True)
class TransformStamped(Message):
    """geometry_msgs/msg/TransformStamped."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/TransformStamped"
    __typehash__: ClassVar[str] = "RIHS01_0a241f87d04668d94099cbb5ba11691d5ad32c2f29682e4eb5653424bd275206"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    child_frame_id: str = ""
    transform: Transform = dataclasses.field(default_factory=Transform)


@dataclass(slots=True)
class Twist(Message):
    """geometry_msgs/msg/Twist."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Twist"
    __typehash__: ClassVar[str] = "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"

    linear: Vector3 = dataclasses.field(default_factory=Vector3)
    angular: Vector3 = dataclasses.field(default_factory=Vector3)


@dataclass(slots=True)
class TwistStamped(Message):
    """geometry_msgs/msg/TwistStamped."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/TwistStamped"
    __typehash__: ClassVar[str] = "RIHS01_5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    twist: Twist = dataclasses.field(default_factory=Twist)


@dataclass(slots=True)
class TwistWithCovariance(Message):
    """geometry_msgs/msg/TwistWithCovariance."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/TwistWithCovariance"
    __typehash__: ClassVar[str] = "RIHS01_49f574f033f095d8b6cd1beaca5ca7925e296e84af1716d16c89d38b059c8c18"

    twist: Twist = dataclasses.field(default_factory=Twist)
    covariance: Annotated[list[Float64], Length(36)] = dataclasses.field(default_factory=lambda: [0.0] * 36)
