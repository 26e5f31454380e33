# Generated from mapping.yaml (SensorBoardPressureInfo); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/SensorBoardPressureInfo."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.sensor_state import SensorState
from roverlink.runtime.core.messages import Bool, Float32, Message, UInt8, UInt32


@dataclass(slots=True)
class SensorBoardPressureInfo(Message):
    """One reading of a pressure sensor."""

    __msgtype__: ClassVar[str] = "comms/msg/SensorBoardPressureInfo"
    __typehash__: ClassVar[str] = (
        "RIHS01_4aa359d2820538041f1fff6076a854a6470f7b25d7d61fdfd886841b72c276f6"
    )

    # Values of error_code
    PRESSURE_NO_ERROR: ClassVar[int] = 0
    PRESSURE_COMMUNICATION_FAILURE: ClassVar[int] = 1
    PRESSURE_OUT_OF_RANGE: ClassVar[int] = 2
    PRESSURE_CALIBRATION_REQUIRED: ClassVar[int] = 3
    PRESSURE_INVALID_DATA: ClassVar[int] = 4
    PRESSURE_SENSOR_FAULT: ClassVar[int] = 5

    sensor_index: UInt32 = 0
    pressure_kpa: Float32 = 0.0
    """Pressure [kPa]."""
    temperature_c: Float32 = 0.0
    """Temperature [degC]."""
    voltage: Float32 = 0.0
    """Voltage [V]."""
    is_calibrated: Bool = False
    state: SensorState = dataclasses.field(default_factory=SensorState)
    error_code: UInt8 = 0
