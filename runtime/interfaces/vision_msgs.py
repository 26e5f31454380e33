"""Messages of the ROS 2 package vision_msgs, in the form that Humble introduced."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Float64, Message
from roverlink.runtime.interfaces import geometry_msgs, std_msgs


@dataclass(slots=True)
class ObjectHypothesis(Message):
    """ROS 2 message vision_msgs/msg/ObjectHypothesis."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/ObjectHypothesis"

    class_id: str = ""
    score: Float64 = 0.0


@dataclass(slots=True)
class ObjectHypothesisWithPose(Message):
    """ROS 2 message vision_msgs/msg/ObjectHypothesisWithPose."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/ObjectHypothesisWithPose"

    hypothesis: ObjectHypothesis = dataclasses.field(default_factory=ObjectHypothesis)
    pose: geometry_msgs.PoseWithCovariance = dataclasses.field(default_factory=geometry_msgs.PoseWithCovariance)


@dataclass(slots=True)
class Point2D(Message):
    """ROS 2 message vision_msgs/msg/Point2D."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/Point2D"

    x: Float64 = 0.0
    y: Float64 = 0.0


@dataclass(slots=True)
class Pose2D(Message):
    """ROS 2 message vision_msgs/msg/Pose2D."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/Pose2D"

    position: Point2D = dataclasses.field(default_factory=Point2D)
    theta: Float64 = 0.0


@dataclass(slots=True)
class BoundingBox2D(Message):
    """ROS 2 message vision_msgs/msg/BoundingBox2D."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/BoundingBox2D"

    center: Pose2D = dataclasses.field(default_factory=Pose2D)
    size_x: Float64 = 0.0
    size_y: Float64 = 0.0


@dataclass(slots=True)
class Detection2D(Message):
    """ROS 2 message vision_msgs/msg/Detection2D."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/Detection2D"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    results: list[ObjectHypothesisWithPose] = dataclasses.field(default_factory=list)
    bbox: BoundingBox2D = dataclasses.field(default_factory=BoundingBox2D)
    id: str = ""


@dataclass(slots=True)
class Detection2DArray(Message):
    """ROS 2 message vision_msgs/msg/Detection2DArray."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/Detection2DArray"
    __typehash__: ClassVar[str] = "RIHS01_214274120007f4a683866481336b70310268cfa107aebe9d594a6acf75bda968"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    detections: list[Detection2D] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class BoundingBox3D(Message):
    """ROS 2 message vision_msgs/msg/BoundingBox3D."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/BoundingBox3D"

    center: geometry_msgs.Pose = dataclasses.field(default_factory=geometry_msgs.Pose)
    size: geometry_msgs.Vector3 = dataclasses.field(default_factory=geometry_msgs.Vector3)


@dataclass(slots=True)
class Detection3D(Message):
    """ROS 2 message vision_msgs/msg/Detection3D."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/Detection3D"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    results: list[ObjectHypothesisWithPose] = dataclasses.field(default_factory=list)
    bbox: BoundingBox3D = dataclasses.field(default_factory=BoundingBox3D)
    id: str = ""


@dataclass(slots=True)
class Detection3DArray(Message):
    """ROS 2 message vision_msgs/msg/Detection3DArray."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/Detection3DArray"
    __typehash__: ClassVar[str] = "RIHS01_793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    detections: list[Detection3D] = dataclasses.field(default_factory=list)
