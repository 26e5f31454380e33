# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The handlers: one class for each row of the table."""

from __future__ import annotations

from generated.handlers.arm_ctrl import ArmCtrlHandler
from generated.handlers.arm_diag import ArmDiagHandler
from generated.handlers.arm_feedback import ArmFeedbackHandler
from generated.handlers.arm_obstructions import ArmObstructionsHandler
from generated.handlers.arm_pos import ArmPosHandler
from generated.handlers.arm_target import ArmTargetHandler
from generated.handlers.control_mode import ControlModeHandler
from generated.handlers.detected_object import DetectedObjectHandler
from generated.handlers.drive_diag import DriveDiagHandler
from generated.handlers.drive_motor import DriveMotorHandler
from generated.handlers.drive_progress import DriveProgressHandler
from generated.handlers.gps_info import GpsInfoHandler
from generated.handlers.imu_info import ImuInfoHandler
from generated.handlers.load_cell_info import LoadCellInfoHandler
from generated.handlers.object_selection import ObjectSelectionHandler
from generated.handlers.ph_info import PhInfoHandler
from generated.handlers.pressure_info import PressureInfoHandler
from generated.handlers.rock_measure_request import RockMeasureRequestHandler
from generated.handlers.rock_measure_result import RockMeasureResultHandler
from generated.handlers.rover_localization import RoverLocalizationHandler
from generated.handlers.sensor_diag import SensorDiagHandler

__all__ = [
    "ArmCtrlHandler",
    "ArmDiagHandler",
    "ArmFeedbackHandler",
    "ArmObstructionsHandler",
    "ArmPosHandler",
    "ArmTargetHandler",
    "ControlModeHandler",
    "DetectedObjectHandler",
    "DriveDiagHandler",
    "DriveMotorHandler",
    "DriveProgressHandler",
    "GpsInfoHandler",
    "ImuInfoHandler",
    "LoadCellInfoHandler",
    "ObjectSelectionHandler",
    "PhInfoHandler",
    "PressureInfoHandler",
    "RockMeasureRequestHandler",
    "RockMeasureResultHandler",
    "RoverLocalizationHandler",
    "SensorDiagHandler",
]
