# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Messages of the ROS 2 package comms."""

from __future__ import annotations

from generated.messages.arm_board_actual_positions import ArmBoardActualPositions
from generated.messages.arm_board_control_signals import ArmBoardControlSignals
from generated.messages.arm_board_diagnostics import ArmBoardDiagnostics
from generated.messages.arm_board_movement_feedback import ArmBoardMovementFeedback
from generated.messages.arm_board_obstructions import ArmBoardObstructions
from generated.messages.arm_board_target_movement import ArmBoardTargetMovement
from generated.messages.basestation_control_mode import BasestationControlMode
from generated.messages.basestation_detected_object import BasestationDetectedObject
from generated.messages.basestation_object_selection import BasestationObjectSelection
from generated.messages.basestation_rock_measure_request import (
    BasestationRockMeasureRequest,
)
from generated.messages.basestation_rock_measure_result import (
    BasestationRockMeasureResult,
)
from generated.messages.basestation_rover_localization import (
    BasestationRoverLocalization,
)
from generated.messages.bounding_box import BoundingBox
from generated.messages.driving_board_diagnostics import DrivingBoardDiagnostics
from generated.messages.driving_board_motor_message import DrivingBoardMotorMessage
from generated.messages.driving_board_motor_periodic_progress import (
    DrivingBoardMotorPeriodicProgress,
)
from generated.messages.imu_sensor_information import ImuSensorInformation
from generated.messages.motor_information import MotorInformation
from generated.messages.sensor_board_diagnostics import SensorBoardDiagnostics
from generated.messages.sensor_board_gps_info import SensorBoardGPSInfo
from generated.messages.sensor_board_load_cell_info import SensorBoardLoadCellInfo
from generated.messages.sensor_board_ph_info import SensorBoardPHInfo
from generated.messages.sensor_board_pressure_info import SensorBoardPressureInfo
from generated.messages.sensor_state import SensorState

__all__ = [
    "ArmBoardActualPositions",
    "ArmBoardControlSignals",
    "ArmBoardDiagnostics",
    "ArmBoardMovementFeedback",
    "ArmBoardObstructions",
    "ArmBoardTargetMovement",
    "BasestationControlMode",
    "BasestationDetectedObject",
    "BasestationObjectSelection",
    "BasestationRockMeasureRequest",
    "BasestationRockMeasureResult",
    "BasestationRoverLocalization",
    "BoundingBox",
    "DrivingBoardDiagnostics",
    "DrivingBoardMotorMessage",
    "DrivingBoardMotorPeriodicProgress",
    "ImuSensorInformation",
    "MotorInformation",
    "SensorBoardDiagnostics",
    "SensorBoardGPSInfo",
    "SensorBoardLoadCellInfo",
    "SensorBoardPHInfo",
    "SensorBoardPressureInfo",
    "SensorState",
]
