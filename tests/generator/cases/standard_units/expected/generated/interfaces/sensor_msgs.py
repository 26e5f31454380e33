# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Messages of the ROS 2 package sensor_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Annotated, ClassVar

from generated.interfaces import geometry_msgs, std_msgs
from roverlink.runtime.core.messages import Float64, Length, Message

__all__ = [
    "FluidPressure",
    "Illuminance",
    "Imu",
    "RelativeHumidity",
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
class Illuminance(Message):
    """sensor_msgs/msg/Illuminance."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/Illuminance"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    illuminance: Float64 = 0.0
    variance: Float64 = 0.0


@dataclass(slots=True)
class Imu(Message):
    """sensor_msgs/msg/Imu."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/Imu"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    orientation: geometry_msgs.Quaternion = dataclasses.field(
        default_factory=geometry_msgs.Quaternion,
    )
    orientation_covariance: Annotated[list[Float64], Length(9)] = dataclasses.field(
        default_factory=lambda: [0.0] * 9,
    )
    angular_velocity: geometry_msgs.Vector3 = dataclasses.field(
        default_factory=geometry_msgs.Vector3,
    )
    angular_velocity_covariance: Annotated[list[Float64], Length(9)] = dataclasses.field(default_factory=lambda: [0.0] * 9)  # fmt: skip
    linear_acceleration: geometry_msgs.Vector3 = dataclasses.field(
        default_factory=geometry_msgs.Vector3,
    )
    linear_acceleration_covariance: Annotated[list[Float64], Length(9)] = dataclasses.field(default_factory=lambda: [0.0] * 9)  # fmt: skip


@dataclass(slots=True)
class RelativeHumidity(Message):
    """sensor_msgs/msg/RelativeHumidity."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/RelativeHumidity"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    relative_humidity: Float64 = 0.0
    variance: Float64 = 0.0


@dataclass(slots=True)
class Temperature(Message):
    """sensor_msgs/msg/Temperature."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/Temperature"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    temperature: Float64 = 0.0
    variance: Float64 = 0.0
