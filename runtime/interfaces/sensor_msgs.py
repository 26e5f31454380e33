# Generated from the definitions of ROS 2; do not edit.
# Regenerate with: make generate
"""Messages of the ROS 2 package sensor_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Annotated, ClassVar

from roverlink.runtime.core.messages import (
    Bool,
    Float64,
    Int8,
    Length,
    Message,
    UInt8,
    UInt16,
    UInt32,
)
from roverlink.runtime.interfaces import geometry_msgs, std_msgs


@dataclass(slots=True)
class RegionOfInterest(Message):
    """sensor_msgs/msg/RegionOfInterest."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/RegionOfInterest"
    __typehash__: ClassVar[str] = "RIHS01_ad16bcba5f9131dcdba6fbded19f726f5440e3c513b4fb586dd3027eeed8abb1"

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

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
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

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    format: str = ""
    data: bytes = b""


@dataclass(slots=True)
class Image(Message):
    """sensor_msgs/msg/Image."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/Image"
    __typehash__: ClassVar[str] = "RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    height: UInt32 = 0
    width: UInt32 = 0
    encoding: str = ""
    is_bigendian: UInt8 = 0
    step: UInt32 = 0
    data: bytes = b""


@dataclass(slots=True)
class Imu(Message):
    """sensor_msgs/msg/Imu."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/Imu"
    __typehash__: ClassVar[str] = "RIHS01_7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    orientation: geometry_msgs.Quaternion = dataclasses.field(default_factory=geometry_msgs.Quaternion)
    orientation_covariance: Annotated[list[Float64], Length(9)] = dataclasses.field(default_factory=lambda: [0.0] * 9)
    angular_velocity: geometry_msgs.Vector3 = dataclasses.field(default_factory=geometry_msgs.Vector3)
    angular_velocity_covariance: Annotated[list[Float64], Length(9)] = dataclasses.field(
        default_factory=lambda: [0.0] * 9
    )
    linear_acceleration: geometry_msgs.Vector3 = dataclasses.field(default_factory=geometry_msgs.Vector3)
    linear_acceleration_covariance: Annotated[list[Float64], Length(9)] = dataclasses.field(
        default_factory=lambda: [0.0] * 9
    )


@dataclass(slots=True)
class NavSatStatus(Message):
    """sensor_msgs/msg/NavSatStatus."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/NavSatStatus"
    __typehash__: ClassVar[str] = "RIHS01_d1ed3befa628e09571bd273b888ba1c1fd187c9a5e0006b385d7e5e9095a3204"

    STATUS_UNKNOWN: ClassVar[int] = -2
    STATUS_NO_FIX: ClassVar[int] = -1
    STATUS_FIX: ClassVar[int] = 0
    STATUS_SBAS_FIX: ClassVar[int] = 1
    STATUS_GBAS_FIX: ClassVar[int] = 2
    SERVICE_UNKNOWN: ClassVar[int] = 0
    SERVICE_GPS: ClassVar[int] = 1
    SERVICE_GLONASS: ClassVar[int] = 2
    SERVICE_COMPASS: ClassVar[int] = 4
    SERVICE_GALILEO: ClassVar[int] = 8

    status: Int8 = 0
    service: UInt16 = 0


@dataclass(slots=True)
class NavSatFix(Message):
    """sensor_msgs/msg/NavSatFix."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/NavSatFix"
    __typehash__: ClassVar[str] = "RIHS01_62223ab3fe210a15976021da7afddc9e200dc9ec75231c1b6a557fc598a65404"

    COVARIANCE_TYPE_UNKNOWN: ClassVar[int] = 0
    COVARIANCE_TYPE_APPROXIMATED: ClassVar[int] = 1
    COVARIANCE_TYPE_DIAGONAL_KNOWN: ClassVar[int] = 2
    COVARIANCE_TYPE_KNOWN: ClassVar[int] = 3

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    status: NavSatStatus = dataclasses.field(default_factory=NavSatStatus)
    latitude: Float64 = 0.0
    longitude: Float64 = 0.0
    altitude: Float64 = 0.0
    position_covariance: Annotated[list[Float64], Length(9)] = dataclasses.field(default_factory=lambda: [0.0] * 9)
    position_covariance_type: UInt8 = 0
