# Generated from mapping.yaml (SensorBoardDiagnostics); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/SensorBoardDiagnostics."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.imu_sensor_information import ImuSensorInformation
from generated.messages.sensor_board_gps_info import SensorBoardGPSInfo
from generated.messages.sensor_board_load_cell_info import SensorBoardLoadCellInfo
from generated.messages.sensor_board_ph_info import SensorBoardPHInfo
from generated.messages.sensor_board_pressure_info import SensorBoardPressureInfo
from roverlink.runtime.core.messages import Float32, Message, UInt8


@dataclass(slots=True)
class SensorBoardDiagnostics(Message):
    """State of the sensor board, with the latest reading of each of its sensors."""

    __msgtype__: ClassVar[str] = "comms/msg/SensorBoardDiagnostics"
    __typehash__: ClassVar[str] = (
        "RIHS01_c8b159833c674c030c9902de4e32ff38200a55bc7c215f96af144996e6a05a36"
    )

    # Values of state
    IDLE: ClassVar[int] = 0
    OPERATING: ClassVar[int] = 1
    CALIBRATING: ClassVar[int] = 2
    ERROR: ClassVar[int] = 3

    state: UInt8 = 0
    ph_sensor: SensorBoardPHInfo = dataclasses.field(default_factory=SensorBoardPHInfo)
    imu_sensor: ImuSensorInformation = dataclasses.field(
        default_factory=ImuSensorInformation
    )
    board_temperature: Float32 = 0.0
    board_voltage: Float32 = 0.0
    """Voltage [V]."""
    gps_sensor: SensorBoardGPSInfo = dataclasses.field(
        default_factory=SensorBoardGPSInfo
    )
    load_cell: SensorBoardLoadCellInfo = dataclasses.field(
        default_factory=SensorBoardLoadCellInfo
    )
    pressure_sensor: SensorBoardPressureInfo = dataclasses.field(
        default_factory=SensorBoardPressureInfo
    )
