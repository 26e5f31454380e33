# Generated from the definitions of ROS 2; do not edit.
# Regenerate with: make generate
"""Messages of the ROS 2 package vision_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Float64, Message
from roverlink.runtime.interfaces import geometry_msgs, std_msgs


@dataclass(slots=True)
class Point2D(Message):
    """vision_msgs/msg/Point2D."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/Point2D"
    __typehash__: ClassVar[str] = "RIHS01_eab0e83f44ab4de92ceaf76dd7d0e7638f2bdd1d16ffbe16c7a136c48e407247"

    x: Float64 = 0.0
    y: Float64 = 0.0


@dataclass(slots=True)
class Pose2D(Message):
    """vision_msgs/msg/Pose2D."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/Pose2D"
    __typehash__: ClassVar[str] = "RIHS01_b0b5d1d7b4c20dd4fcde3ed1d4b289a919290572007d67a97043814db25d3648"

    position: Point2D = dataclasses.field(default_factory=Point2D)
    theta: Float64 = 0.0


@dataclass(slots=True)
class BoundingBox2D(Message):
    """vision_msgs/msg/BoundingBox2D."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/BoundingBox2D"
    __typehash__: ClassVar[str] = "RIHS01_008eacbb0cf8f26e83795547bed013eec3675485ef386ec056d80eaaf1c1ce2f"

    center: Pose2D = dataclasses.field(default_factory=Pose2D)
    size_x: Float64 = 0.0
    size_y: Float64 = 0.0


@dataclass(slots=True)
class BoundingBox3D(Message):
    """vision_msgs/msg/BoundingBox3D."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/BoundingBox3D"
    __typehash__: ClassVar[str] = "RIHS01_bbb73a65c163d7f9bb29009c7bde9f7faa576bd2d23299c4511d19230dab4698"

    center: geometry_msgs.Pose = dataclasses.field(default_factory=geometry_msgs.Pose)
    size: geometry_msgs.Vector3 = dataclasses.field(default_factory=geometry_msgs.Vector3)


@dataclass(slots=True)
class ObjectHypothesis(Message):
    """vision_msgs/msg/ObjectHypothesis."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/ObjectHypothesis"
    __typehash__: ClassVar[str] = "RIHS01_51da43cec11c01957a64d1e05a24acd18aae7745ec30b74348ad5f6d634f7f90"

    class_id: str = ""
    score: Float64 = 0.0


@dataclass(slots=True)
class ObjectHypothesisWithPose(Message):
    """vision_msgs/msg/ObjectHypothesisWithPose."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/ObjectHypothesisWithPose"
    __typehash__: ClassVar[str] = "RIHS01_41c12344c0396c48b81df12467c192d99b2a0eb1463c5c37194e4223251c80bc"

    hypothesis: ObjectHypothesis = dataclasses.field(default_factory=ObjectHypothesis)
    pose: geometry_msgs.PoseWithCovariance = dataclasses.field(default_factory=geometry_msgs.PoseWithCovariance)


@dataclass(slots=True)
class Detection2D(Message):
    """vision_msgs/msg/Detection2D."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/Detection2D"
    __typehash__: ClassVar[str] = "RIHS01_0d12b69df5c593b3455b7346fac8205437a7d4bcb09b9e0e0b2dde787ded38ea"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    results: list[ObjectHypothesisWithPose] = dataclasses.field(default_factory=list)
    bbox: BoundingBox2D = dataclasses.field(default_factory=BoundingBox2D)
    id: str = ""


@dataclass(slots=True)
class Detection2DArray(Message):
    """vision_msgs/msg/Detection2DArray."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/Detection2DArray"
    __typehash__: ClassVar[str] = "RIHS01_214274120007f4a683866481336b70310268cfa107aebe9d594a6acf75bda968"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    detections: list[Detection2D] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class Detection3D(Message):
    """vision_msgs/msg/Detection3D."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/Detection3D"
    __typehash__: ClassVar[str] = "RIHS01_ddd703be132ab0b69d33121f1bb034132bfbb3b0ac5f9fb1516005ba1c8a265b"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    results: list[ObjectHypothesisWithPose] = dataclasses.field(default_factory=list)
    bbox: BoundingBox3D = dataclasses.field(default_factory=BoundingBox3D)
    id: str = ""


@dataclass(slots=True)
class Detection3DArray(Message):
    """vision_msgs/msg/Detection3DArray."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/Detection3DArray"
    __typehash__: ClassVar[str] = "RIHS01_793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    detections: list[Detection3D] = dataclasses.field(default_factory=list)
