# Generated from mapping.yaml (SensorBoardIMUInfo); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/ImuSensorInformation."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.sensor_state import SensorState
from roverlink.runtime.core.messages import Bool, Float32, Message, UInt8


@dataclass(slots=True)
class ImuSensorInformation(Message):
    """One sample of the inertial measurement unit."""

    __msgtype__: ClassVar[str] = "comms/msg/ImuSensorInformation"
    __typehash__: ClassVar[str] = (
        "RIHS01_7563fa22f8050e4d49a7653adb6c82fbf1c40733747a27f4d18957fbc0018030"
    )

    # Values of error_code
    IMU_NO_ERROR: ClassVar[int] = 0
    IMU_COMMUNICATION_FAILURE: ClassVar[int] = 1
    IMU_CALIBRATION_REQUIRED: ClassVar[int] = 2
    IMU_CALIBRATION_FAILED: ClassVar[int] = 3
    IMU_INVALID_DATA: ClassVar[int] = 4
    IMU_SENSOR_FAULT: ClassVar[int] = 5
    IMU_GYROSCOPE_ERROR: ClassVar[int] = 6
    IMU_MAGNETOMETER_ERROR: ClassVar[int] = 7
    IMU_ACCELEROMETER_ERROR: ClassVar[int] = 8

    accel_x: Float32 = 0.0
    accel_y: Float32 = 0.0
    accel_z: Float32 = 0.0
    gyro_x: Float32 = 0.0
    gyro_y: Float32 = 0.0
    gyro_z: Float32 = 0.0
    mag_x: Float32 = 0.0
    mag_y: Float32 = 0.0
    mag_z: Float32 = 0.0
    is_calibrated: Bool = False
    state: SensorState = dataclasses.field(default_factory=SensorState)
    error_code: UInt8 = 0
