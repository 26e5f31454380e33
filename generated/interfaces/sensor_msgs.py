# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Messages of the ROS 2 package sensor_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Annotated, ClassVar

from generated.interfaces import geometry_msgs, std_msgs
from roverlink.runtime.core.messages import Float64, Length, Message
from roverlink.runtime.interfaces.sensor_msgs import Imu, NavSatFix, NavSatStatus

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
class Temperature(Message):
    """sensor_msgs/msg/Temperature."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/Temperature"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    temperature: Float64 = 0.0
    variance: Float64 = 0.0
