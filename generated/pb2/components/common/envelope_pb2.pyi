# Generated from components/common/envelope.proto; do not edit.
# Regenerate with: roverlink generate
from generated.pb2.components.arm_board import motor_diagnostics_pb2 as _motor_diagnostics_pb2
from generated.pb2.components.arm_board import movement_control_in_pb2 as _movement_control_in_pb2
from generated.pb2.components.arm_board import movement_software_feedback_pb2 as _movement_software_feedback_pb2
from generated.pb2.components.arm_board import movement_software_target_pb2 as _movement_software_target_pb2
from generated.pb2.components.basestation import control_mode_pb2 as _control_mode_pb2
from generated.pb2.components.basestation import detected_object_pb2 as _detected_object_pb2
from generated.pb2.components.basestation import object_selection_pb2 as _object_selection_pb2
from generated.pb2.components.basestation import rock_measure_request_pb2 as _rock_measure_request_pb2
from generated.pb2.components.basestation import rock_measure_result_pb2 as _rock_measure_result_pb2
from generated.pb2.components.basestation import rover_localization_pb2 as _rover_localization_pb2
from generated.pb2.components.driving_board import motor_diagnostics_pb2 as _motor_diagnostics_pb2_1
from generated.pb2.components.driving_board import motor_msg_pb2 as _motor_msg_pb2
from generated.pb2.components.driving_board import motor_periodic_progress_pb2 as _motor_periodic_progress_pb2
from generated.pb2.components.sensor_board import diagnostics_pb2 as _diagnostics_pb2
from generated.pb2.components.sensor_board import gps_sensor_pb2 as _gps_sensor_pb2
from generated.pb2.components.sensor_board import imu_sensor_pb2 as _imu_sensor_pb2
from generated.pb2.components.sensor_board import load_cell_pb2 as _load_cell_pb2
from generated.pb2.components.sensor_board import ph_sensor_pb2 as _ph_sensor_pb2
from generated.pb2.components.sensor_board import pressure_sensor_pb2 as _pressure_sensor_pb2
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class PBEnvelope(_message.Message):
    __slots__ = ("ph_info", "arm_ctrl", "arm_diag", "arm_feedback", "arm_pos", "arm_target", "arm_obstructions", "drive_diag", "drive_motor", "drive_progress", "sensor_diag", "gps_info", "imu_info", "load_cell_info", "pressure_info", "control_mode", "detected_object", "object_selection", "rock_measure_request", "rock_measure_result", "rover_localization")
    PH_INFO_FIELD_NUMBER: _ClassVar[int]
    ARM_CTRL_FIELD_NUMBER: _ClassVar[int]
    ARM_DIAG_FIELD_NUMBER: _ClassVar[int]
    ARM_FEEDBACK_FIELD_NUMBER: _ClassVar[int]
    ARM_POS_FIELD_NUMBER: _ClassVar[int]
    ARM_TARGET_FIELD_NUMBER: _ClassVar[int]
    ARM_OBSTRUCTIONS_FIELD_NUMBER: _ClassVar[int]
    DRIVE_DIAG_FIELD_NUMBER: _ClassVar[int]
    DRIVE_MOTOR_FIELD_NUMBER: _ClassVar[int]
    DRIVE_PROGRESS_FIELD_NUMBER: _ClassVar[int]
    SENSOR_DIAG_FIELD_NUMBER: _ClassVar[int]
    GPS_INFO_FIELD_NUMBER: _ClassVar[int]
    IMU_INFO_FIELD_NUMBER: _ClassVar[int]
    LOAD_CELL_INFO_FIELD_NUMBER: _ClassVar[int]
    PRESSURE_INFO_FIELD_NUMBER: _ClassVar[int]
    CONTROL_MODE_FIELD_NUMBER: _ClassVar[int]
    DETECTED_OBJECT_FIELD_NUMBER: _ClassVar[int]
    OBJECT_SELECTION_FIELD_NUMBER: _ClassVar[int]
    ROCK_MEASURE_REQUEST_FIELD_NUMBER: _ClassVar[int]
    ROCK_MEASURE_RESULT_FIELD_NUMBER: _ClassVar[int]
    ROVER_LOCALIZATION_FIELD_NUMBER: _ClassVar[int]
    ph_info: _ph_sensor_pb2.SensorBoardPHInfo
    arm_ctrl: _movement_control_in_pb2.ArmBoardControlSignals
    arm_diag: _motor_diagnostics_pb2.ArmBoardDiagnostics
    arm_feedback: _movement_software_feedback_pb2.ArmBoardMovementFeedback
    arm_pos: _movement_software_feedback_pb2.ArmBoardActualPositions
    arm_target: _movement_software_target_pb2.ArmBoardTargetMovement
    arm_obstructions: _movement_software_target_pb2.ArmBoardObstructions
    drive_diag: _motor_diagnostics_pb2_1.DrivingBoardDiagnostics
    drive_motor: _motor_msg_pb2.DrivingBoardMotorMessage
    drive_progress: _motor_periodic_progress_pb2.DrivingBoardMotorPeriodicProgress
    sensor_diag: _diagnostics_pb2.SensorBoardDiagnostics
    gps_info: _gps_sensor_pb2.SensorBoardGPSInfo
    imu_info: _imu_sensor_pb2.SensorBoardIMUInfo
    load_cell_info: _load_cell_pb2.SensorBoardLoadCellInfo
    pressure_info: _pressure_sensor_pb2.SensorBoardPressureInfo
    control_mode: _control_mode_pb2.BasestationControlMode
    detected_object: _detected_object_pb2.BasestationDetectedObject
    object_selection: _object_selection_pb2.BasestationObjectSelection
    rock_measure_request: _rock_measure_request_pb2.BasestationRockMeasureRequest
    rock_measure_result: _rock_measure_result_pb2.BasestationRockMeasureResult
    rover_localization: _rover_localization_pb2.BasestationRoverLocalization
    def __init__(self, ph_info: _Optional[_Union[_ph_sensor_pb2.SensorBoardPHInfo, _Mapping]] = ..., arm_ctrl: _Optional[_Union[_movement_control_in_pb2.ArmBoardControlSignals, _Mapping]] = ..., arm_diag: _Optional[_Union[_motor_diagnostics_pb2.ArmBoardDiagnostics, _Mapping]] = ..., arm_feedback: _Optional[_Union[_movement_software_feedback_pb2.ArmBoardMovementFeedback, _Mapping]] = ..., arm_pos: _Optional[_Union[_movement_software_feedback_pb2.ArmBoardActualPositions, _Mapping]] = ..., arm_target: _Optional[_Union[_movement_software_target_pb2.ArmBoardTargetMovement, _Mapping]] = ..., arm_obstructions: _Optional[_Union[_movement_software_target_pb2.ArmBoardObstructions, _Mapping]] = ..., drive_diag: _Optional[_Union[_motor_diagnostics_pb2_1.DrivingBoardDiagnostics, _Mapping]] = ..., drive_motor: _Optional[_Union[_motor_msg_pb2.DrivingBoardMotorMessage, _Mapping]] = ..., drive_progress: _Optional[_Union[_motor_periodic_progress_pb2.DrivingBoardMotorPeriodicProgress, _Mapping]] = ..., sensor_diag: _Optional[_Union[_diagnostics_pb2.SensorBoardDiagnostics, _Mapping]] = ..., gps_info: _Optional[_Union[_gps_sensor_pb2.SensorBoardGPSInfo, _Mapping]] = ..., imu_info: _Optional[_Union[_imu_sensor_pb2.SensorBoardIMUInfo, _Mapping]] = ..., load_cell_info: _Optional[_Union[_load_cell_pb2.SensorBoardLoadCellInfo, _Mapping]] = ..., pressure_info: _Optional[_Union[_pressure_sensor_pb2.SensorBoardPressureInfo, _Mapping]] = ..., control_mode: _Optional[_Union[_control_mode_pb2.BasestationControlMode, _Mapping]] = ..., detected_object: _Optional[_Union[_detected_object_pb2.BasestationDetectedObject, _Mapping]] = ..., object_selection: _Optional[_Union[_object_selection_pb2.BasestationObjectSelection, _Mapping]] = ..., rock_measure_request: _Optional[_Union[_rock_measure_request_pb2.BasestationRockMeasureRequest, _Mapping]] = ..., rock_measure_result: _Optional[_Union[_rock_measure_result_pb2.BasestationRockMeasureResult, _Mapping]] = ..., rover_localization: _Optional[_Union[_rover_localization_pb2.BasestationRoverLocalization, _Mapping]] = ...) -> None: ...
