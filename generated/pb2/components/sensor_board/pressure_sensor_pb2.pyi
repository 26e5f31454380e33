# Generated from components/sensor_board/pressure_sensor.proto; do not edit.
# Regenerate with: roverlink generate
from generated.pb2.components.sensor_board import sensor_pb2 as _sensor_pb2
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class PressureErrorCode(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    PRESSURE_NO_ERROR: _ClassVar[PressureErrorCode]
    PRESSURE_COMMUNICATION_FAILURE: _ClassVar[PressureErrorCode]
    PRESSURE_OUT_OF_RANGE: _ClassVar[PressureErrorCode]
    PRESSURE_CALIBRATION_REQUIRED: _ClassVar[PressureErrorCode]
    PRESSURE_INVALID_DATA: _ClassVar[PressureErrorCode]
    PRESSURE_SENSOR_FAULT: _ClassVar[PressureErrorCode]
PRESSURE_NO_ERROR: PressureErrorCode
PRESSURE_COMMUNICATION_FAILURE: PressureErrorCode
PRESSURE_OUT_OF_RANGE: PressureErrorCode
PRESSURE_CALIBRATION_REQUIRED: PressureErrorCode
PRESSURE_INVALID_DATA: PressureErrorCode
PRESSURE_SENSOR_FAULT: PressureErrorCode

class SensorBoardPressureInfo(_message.Message):
    __slots__ = ("sensor_index", "pressure_kpa", "temperature_c", "voltage", "is_calibrated", "state", "error_code")
    SENSOR_INDEX_FIELD_NUMBER: _ClassVar[int]
    PRESSURE_KPA_FIELD_NUMBER: _ClassVar[int]
    TEMPERATURE_C_FIELD_NUMBER: _ClassVar[int]
    VOLTAGE_FIELD_NUMBER: _ClassVar[int]
    IS_CALIBRATED_FIELD_NUMBER: _ClassVar[int]
    STATE_FIELD_NUMBER: _ClassVar[int]
    ERROR_CODE_FIELD_NUMBER: _ClassVar[int]
    sensor_index: int
    pressure_kpa: float
    temperature_c: float
    voltage: float
    is_calibrated: bool
    state: _sensor_pb2.SensorState
    error_code: PressureErrorCode
    def __init__(self, sensor_index: _Optional[int] = ..., pressure_kpa: _Optional[float] = ..., temperature_c: _Optional[float] = ..., voltage: _Optional[float] = ..., is_calibrated: _Optional[bool] = ..., state: _Optional[_Union[_sensor_pb2.SensorState, int, str]] = ..., error_code: _Optional[_Union[PressureErrorCode, int, str]] = ...) -> None: ...
