# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Messages of the ROS 2 package sensor_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Annotated, ClassVar

from generated.interfaces import geometry_msgs, std_msgs
from roverlink.runtime.core.messages import (
    Float64,
    Int8,
    Length,
    Message,
    UInt8,
    UInt16,
)

__all__ = [
    "FluidPressure",
    "Imu",
    "MagneticField",
    "NavSatFix",
    "NavSatStatus",
    "Temperature",
]


@dataclass(slots=True)
class FluidPressure(Message):
    """sensor_msgs/msg/FluidPressure."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/FluidPressure"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    fluid_pressure: Float64 = 0.0
    variance: Float64 = 0.0


@dataclass(slots=True)
class Imu(Message):
    """sensor_msgs/msg/Imu."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/Imu"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    orientation: geometry_msgs.Quaternion = dataclasses.field(
        default_factory=geometry_msgs.Quaternion
    )
    orientation_covariance: Annotated[list[Float64], Length(9)] = dataclasses.field(
        default_factory=lambda: [0.0] * 9
    )
    angular_velocity: geometry_msgs.Vector3 = dataclasses.field(
        default_factory=geometry_msgs.Vector3
    )
    angular_velocity_covariance: Annotated[list[Float64], Length(9)] = (
        dataclasses.field(default_factory=lambda: [0.0] * 9)
    )
    linear_acceleration: geometry_msgs.Vector3 = dataclasses.field(
        default_factory=geometry_msgs.Vector3
    )
    linear_acceleration_covariance: Annotated[list[Float64], Length(9)] = (
        dataclasses.field(default_factory=lambda: [0.0] * 9)
    )


@dataclass(slots=True)
class MagneticField(Message):
    """sensor_msgs/msg/MagneticField."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/MagneticField"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    magnetic_field: geometry_msgs.Vector3 = dataclasses.field(
        default_factory=geometry_msgs.Vector3
    )
    magnetic_field_covariance: Annotated[list[Float64], Length(9)] = dataclasses.field(
        default_factory=lambda: [0.0] * 9
    )


@dataclass(slots=True)
class NavSatStatus(Message):
    """sensor_msgs/msg/NavSatStatus."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/NavSatStatus"

    STATUS_NO_FIX: ClassVar[int] = -1
    STATUS_FIX: ClassVar[int] = 0
    STATUS_SBAS_FIX: ClassVar[int] = 1
    STATUS_GBAS_FIX: ClassVar[int] = 2
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

    COVARIANCE_TYPE_UNKNOWN: ClassVar[int] = 0
    COVARIANCE_TYPE_APPROXIMATED: ClassVar[int] = 1
    COVARIANCE_TYPE_DIAGONAL_KNOWN: ClassVar[int] = 2
    COVARIANCE_TYPE_KNOWN: ClassVar[int] = 3

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    status: NavSatStatus = dataclasses.field(default_factory=NavSatStatus)
    latitude: Float64 = 0.0
    longitude: Float64 = 0.0
    altitude: Float64 = 0.0
    position_covariance: Annotated[list[Float64], Length(9)] = dataclasses.field(
        default_factory=lambda: [0.0] * 9
    )
    position_covariance_type: UInt8 = 0


@dataclass(slots=True)
class Temperature(Message):
    """sensor_msgs/msg/Temperature."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/Temperature"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    temperature: Float64 = 0.0
    variance: Float64 = 0.0
