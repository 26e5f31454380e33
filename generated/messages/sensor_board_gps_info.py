# Generated from mapping.yaml (SensorBoardGPSInfo); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/SensorBoardGPSInfo."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.sensor_state import SensorState
from roverlink.runtime.core.messages import (
    Float32,
    Float64,
    Int32,
    Int64,
    Message,
    UInt8,
)


@dataclass(slots=True)
class SensorBoardGPSInfo(Message):
    """One fix of the GPS receiver."""

    __msgtype__: ClassVar[str] = "comms/msg/SensorBoardGPSInfo"
    __typehash__: ClassVar[str] = (
        "RIHS01_a6653d650a4b055d2bdd1ff2bedd117009f6eb8f0e648528fc1a382bc380379a"
    )

    # Values of fix_quality
    NO_FIX: ClassVar[int] = 0
    GPS_FIX: ClassVar[int] = 1
    DGPS_FIX: ClassVar[int] = 2
    PPS_FIX: ClassVar[int] = 3
    RTK_FIX: ClassVar[int] = 4
    RTK_FLOAT: ClassVar[int] = 5

    # Values of error_code
    GPS_NO_ERROR: ClassVar[int] = 0
    GPS_COMMUNICATION_FAILURE: ClassVar[int] = 1
    GPS_INVALID_DATA: ClassVar[int] = 2
    GPS_ANTENNA_FAULT: ClassVar[int] = 3
    GPS_LOW_SIGNAL_QUALITY: ClassVar[int] = 4

    latitude: Float64 = 0.0
    """North is positive [deg]."""
    longitude: Float64 = 0.0
    """East is positive [deg]."""
    altitude: Float32 = 0.0
    speed: Float32 = 0.0
    heading: Float32 = 0.0
    hdop: Float32 = 0.0
    """Horizontal dilution of precision."""
    vdop: Float32 = 0.0
    """Vertical dilution of precision."""
    satellites: Int32 = 0
    fix_quality: UInt8 = 0
    state: SensorState = dataclasses.field(default_factory=SensorState)
    error_code: UInt8 = 0
    utc_timestamp: Int64 = 0
