"""Messages of ROS 2's common interfaces that a camera program speaks; those of vision_msgs as they are since Humble.

Written by hand, as `runtime.interfaces` is; a test compares them with ROS 2's definitions. What is published has its
type's hash, which ROS 2 compares from Iron on.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Annotated, ClassVar

from runtime.interfaces import Header
from runtime.messages import Bool, Float64, Length, Message, UInt32


@dataclass(slots=True)
class Vector3(Message):
    """geometry_msgs/msg/Vector3."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Vector3"

    x: Float64 = 0.0
    y: Float64 = 0.0
    z: Float64 = 0.0


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
class Transform(Message):
    """geometry_msgs/msg/Transform."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Transform"

    translation: Vector3 = dataclasses.field(default_factory=Vector3)
    rotation: Quaternion = dataclasses.field(default_factory=Quaternion)


@dataclass(slots=True)
class TransformStamped(Message):
    """geometry_msgs/msg/TransformStamped."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/TransformStamped"

    header: Header = dataclasses.field(default_factory=Header)
    child_frame_id: str = ""
    transform: Transform = dataclasses.field(default_factory=Transform)


@dataclass(slots=True)
class TFMessage(Message):
    """tf2_msgs/msg/TFMessage."""

    __msgtype__: ClassVar[str] = "tf2_msgs/msg/TFMessage"
    __typehash__: ClassVar[str] = "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"

    transforms: list[TransformStamped] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class Pose(Message):
    """geometry_msgs/msg/Pose."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Pose"

    position: Point = dataclasses.field(default_factory=Point)
    orientation: Quaternion = dataclasses.field(default_factory=Quaternion)


@dataclass(slots=True)
class PoseWithCovariance(Message):
    """geometry_msgs/msg/PoseWithCovariance."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/PoseWithCovariance"

    pose: Pose = dataclasses.field(default_factory=Pose)
    covariance: Annotated[list[Float64], Length(36)] = dataclasses.field(default_factory=lambda: [0.0] * 36)


@dataclass(slots=True)
class PoseWithCovarianceStamped(Message):
    """geometry_msgs/msg/PoseWithCovarianceStamped."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/PoseWithCovarianceStamped"
    __typehash__: ClassVar[str] = "RIHS01_26432f9803e43727d3c8f668d1fdb3c630f548af631e2f4e31382371bfea3b6e"

    header: Header = dataclasses.field(default_factory=Header)
    pose: PoseWithCovariance = dataclasses.field(default_factory=PoseWithCovariance)


@dataclass(slots=True)
class ObjectHypothesis(Message):
    """vision_msgs/msg/ObjectHypothesis."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/ObjectHypothesis"

    class_id: str = ""
    score: Float64 = 0.0


@dataclass(slots=True)
class ObjectHypothesisWithPose(Message):
    """vision_msgs/msg/ObjectHypothesisWithPose."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/ObjectHypothesisWithPose"

    hypothesis: ObjectHypothesis = dataclasses.field(default_factory=ObjectHypothesis)
    pose: PoseWithCovariance = dataclasses.field(default_factory=PoseWithCovariance)


@dataclass(slots=True)
class BoundingBox3D(Message):
    """vision_msgs/msg/BoundingBox3D."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/BoundingBox3D"

    center: Pose = dataclasses.field(default_factory=Pose)
    size: Vector3 = dataclasses.field(default_factory=Vector3)


@dataclass(slots=True)
class Detection3D(Message):
    """vision_msgs/msg/Detection3D."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/Detection3D"

    header: Header = dataclasses.field(default_factory=Header)
    results: list[ObjectHypothesisWithPose] = dataclasses.field(default_factory=list)
    bbox: BoundingBox3D = dataclasses.field(default_factory=BoundingBox3D)
    id: str = ""


@dataclass(slots=True)
class Detection3DArray(Message):
    """vision_msgs/msg/Detection3DArray."""

    __msgtype__: ClassVar[str] = "vision_msgs/msg/Detection3DArray"
    __typehash__: ClassVar[str] = "RIHS01_793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018"

    header: Header = dataclasses.field(default_factory=Header)
    detections: list[Detection3D] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class RegionOfInterest(Message):
    """sensor_msgs/msg/RegionOfInterest."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/RegionOfInterest"

    x_offset: UInt32 = 0
    y_offset: UInt32 = 0
    height: UInt32 = 0
    width: UInt32 = 0
    do_rectify: Bool = False


@dataclass(slots=True)
class CameraInfo(Message):
    """sensor_msgs/msg/CameraInfo."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/CameraInfo"
    __typehash__: ClassVar[str] = "RIHS01_b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275"

    header: Header = dataclasses.field(default_factory=Header)
    height: UInt32 = 0
    width: UInt32 = 0
    distortion_model: str = ""
    d: list[Float64] = dataclasses.field(default_factory=list)
    k: Annotated[list[Float64], Length(9)] = dataclasses.field(default_factory=lambda: [0.0] * 9)
    r: Annotated[list[Float64], Length(9)] = dataclasses.field(default_factory=lambda: [0.0] * 9)
    p: Annotated[list[Float64], Length(12)] = dataclasses.field(default_factory=lambda: [0.0] * 12)
    binning_x: UInt32 = 0
    binning_y: UInt32 = 0
    roi: RegionOfInterest = dataclasses.field(default_factory=RegionOfInterest)


@dataclass(slots=True)
class CompressedImage(Message):
    """sensor_msgs/msg/CompressedImage."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/CompressedImage"
    __typehash__: ClassVar[str] = "RIHS01_15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a"

    header: Header = dataclasses.field(default_factory=Header)
    format: str = ""
    data: bytes = b""
