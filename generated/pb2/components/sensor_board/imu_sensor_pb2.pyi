# Generated from components/sensor_board/imu_sensor.proto; do not edit.
# Regenerate with: roverlink generate
from generated.pb2.components.sensor_board import sensor_pb2 as _sensor_pb2
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class IMUErrorCode(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    IMU_NO_ERROR: _ClassVar[IMUErrorCode]
    IMU_COMMUNICATION_FAILURE: _ClassVar[IMUErrorCode]
    IMU_CALIBRATION_REQUIRED: _ClassVar[IMUErrorCode]
    IMU_CALIBRATION_FAILED: _ClassVar[IMUErrorCode]
    IMU_INVALID_DATA: _ClassVar[IMUErrorCode]
    IMU_SENSOR_FAULT: _ClassVar[IMUErrorCode]
    IMU_GYROSCOPE_ERROR: _ClassVar[IMUErrorCode]
    IMU_MAGNETOMETER_ERROR: _ClassVar[IMUErrorCode]
    IMU_ACCELEROMETER_ERROR: _ClassVar[IMUErrorCode]
IMU_NO_ERROR: IMUErrorCode
IMU_COMMUNICATION_FAILURE: IMUErrorCode
IMU_CALIBRATION_REQUIRED: IMUErrorCode
IMU_CALIBRATION_FAILED: IMUErrorCode
IMU_INVALID_DATA: IMUErrorCode
IMU_SENSOR_FAULT: IMUErrorCode
IMU_GYROSCOPE_ERROR: IMUErrorCode
IMU_MAGNETOMETER_ERROR: IMUErrorCode
IMU_ACCELEROMETER_ERROR: IMUErrorCode

class SensorBoardIMUInfo(_message.Message):
    __slots__ = ("accel_x", "accel_y", "accel_z", "gyro_x", "gyro_y", "gyro_z", "mag_x", "mag_y", "mag_z", "is_calibrated", "state", "error_code")
    ACCEL_X_FIELD_NUMBER: _ClassVar[int]
    ACCEL_Y_FIELD_NUMBER: _ClassVar[int]
    ACCEL_Z_FIELD_NUMBER: _ClassVar[int]
    GYRO_X_FIELD_NUMBER: _ClassVar[int]
    GYRO_Y_FIELD_NUMBER: _ClassVar[int]
    GYRO_Z_FIELD_NUMBER: _ClassVar[int]
    MAG_X_FIELD_NUMBER: _ClassVar[int]
    MAG_Y_FIELD_NUMBER: _ClassVar[int]
    MAG_Z_FIELD_NUMBER: _ClassVar[int]
    IS_CALIBRATED_FIELD_NUMBER: _ClassVar[int]
    STATE_FIELD_NUMBER: _ClassVar[int]
    ERROR_CODE_FIELD_NUMBER: _ClassVar[int]
    accel_x: float
    accel_y: float
    accel_z: float
    gyro_x: float
    gyro_y: float
    gyro_z: float
    mag_x: float
    mag_y: float
    mag_z: float
    is_calibrated: bool
    state: _sensor_pb2.SensorState
    error_code: IMUErrorCode
    def __init__(self, accel_x: _Optional[float] = ..., accel_y: _Optional[float] = ..., accel_z: _Optional[float] = ..., gyro_x: _Optional[float] = ..., gyro_y: _Optional[float] = ..., gyro_z: _Optional[float] = ..., mag_x: _Optional[float] = ..., mag_y: _Optional[float] = ..., mag_z: _Optional[float] = ..., is_calibrated: _Optional[bool] = ..., state: _Optional[_Union[_sensor_pb2.SensorState, int, str]] = ..., error_code: _Optional[_Union[IMUErrorCode, int, str]] = ...) -> None: ...
