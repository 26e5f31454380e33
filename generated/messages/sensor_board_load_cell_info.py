# Generated from mapping.yaml (SensorBoardLoadCellInfo); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/SensorBoardLoadCellInfo."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.sensor_state import SensorState
from roverlink.runtime.core.messages import Bool, Float32, Int32, Message, UInt8, UInt32


@dataclass(slots=True)
class SensorBoardLoadCellInfo(Message):
    """One reading of a load cell."""

    __msgtype__: ClassVar[str] = "comms/msg/SensorBoardLoadCellInfo"
    __typehash__: ClassVar[str] = (
        "RIHS01_6418cf6640f1090bcd96af6545f0275a79b95ff0d880e9dfd6f8da19697e182c"
    )

    # Values of error_code
    LOAD_CELL_NO_ERROR: ClassVar[int] = 0
    LOAD_CELL_COMMUNICATION_FAILURE: ClassVar[int] = 1
    LOAD_CELL_OUT_OF_RANGE: ClassVar[int] = 2
    LOAD_CELL_CALIBRATION_REQUIRED: ClassVar[int] = 3
    LOAD_CELL_INVALID_DATA: ClassVar[int] = 4
    LOAD_CELL_SENSOR_FAULT: ClassVar[int] = 5

    sensor_index: UInt32 = 0
    force_newtons: Float32 = 0.0
    """Force [N]."""
    mass_grams: Float32 = 0.0
    """Mass [g]."""
    raw_counts: Int32 = 0
    is_calibrated: Bool = False
    scale_newtons_per_count: Float32 = 0.0
    """Force of one count [N]."""
    tare_offset_counts: Int32 = 0
    state: SensorState = dataclasses.field(default_factory=SensorState)
    error_code: UInt8 = 0
