# Generated from mapping.yaml (SensorBoardPHInfo); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/SensorBoardPHInfo."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.sensor_state import SensorState
from roverlink.runtime.core.messages import Float32, Message, UInt8


@dataclass(slots=True)
class SensorBoardPHInfo(Message):
    """One reading of the pH probe."""

    __msgtype__: ClassVar[str] = "comms/msg/SensorBoardPHInfo"
    __typehash__: ClassVar[str] = (
        "RIHS01_0493b2d34bc7a27cdfa7fa9bac2463b89182724378217475c3a15f703ba1d00e"
    )

    # Values of error_code
    PH_NO_ERROR: ClassVar[int] = 0
    PH_COMMUNICATION_FAILURE: ClassVar[int] = 1
    PH_OUT_OF_RANGE: ClassVar[int] = 2
    PH_CALIBRATION_REQUIRED: ClassVar[int] = 3
    PH_INVALID_DATA: ClassVar[int] = 4
    PH_PROBE_FAULT: ClassVar[int] = 5
    PH_TEMPERATURE_SENSOR_ERROR: ClassVar[int] = 6

    ph_value: Float32 = 0.0
    voltage: Float32 = 0.0
    """Voltage [V]."""
    temperature: Float32 = 0.0
    state: SensorState = dataclasses.field(default_factory=SensorState)
    error_code: UInt8 = 0
