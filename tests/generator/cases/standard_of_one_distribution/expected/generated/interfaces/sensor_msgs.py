# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Messages of the ROS 2 package sensor_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.interfaces import std_msgs
from roverlink.runtime.core.messages import Float32, Int8, Message, UInt8, UInt16

__all__ = [
    "NavSatStatus",
    "Range",
]


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
    STATUS_UNKNOWN: ClassVar[int] = -2
    SERVICE_UNKNOWN: ClassVar[int] = 0

    status: Int8 = 0
    service: UInt16 = 0


@dataclass(slots=True)
class Range(Message):
    """sensor_msgs/msg/Range."""

    __msgtype__: ClassVar[str] = "sensor_msgs/msg/Range"

    ULTRASOUND: ClassVar[int] = 0
    INFRARED: ClassVar[int] = 1

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    radiation_type: UInt8 = 0
    field_of_view: Float32 = 0.0
    min_range: Float32 = 0.0
    max_range: Float32 = 0.0
    range: Float32 = 0.0
    variance: Float32 = 0.0
