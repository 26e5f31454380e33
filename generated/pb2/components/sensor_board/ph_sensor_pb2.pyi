# Generated from components/sensor_board/ph_sensor.proto; do not edit.
# Regenerate with: roverlink generate
from generated.pb2.components.sensor_board import sensor_pb2 as _sensor_pb2
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class PHErrorCode(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    PH_NO_ERROR: _ClassVar[PHErrorCode]
    PH_COMMUNICATION_FAILURE: _ClassVar[PHErrorCode]
    PH_OUT_OF_RANGE: _ClassVar[PHErrorCode]
    PH_CALIBRATION_REQUIRED: _ClassVar[PHErrorCode]
    PH_INVALID_DATA: _ClassVar[PHErrorCode]
    PH_PROBE_FAULT: _ClassVar[PHErrorCode]
    PH_TEMPERATURE_SENSOR_ERROR: _ClassVar[PHErrorCode]
PH_NO_ERROR: PHErrorCode
PH_COMMUNICATION_FAILURE: PHErrorCode
PH_OUT_OF_RANGE: PHErrorCode
PH_CALIBRATION_REQUIRED: PHErrorCode
PH_INVALID_DATA: PHErrorCode
PH_PROBE_FAULT: PHErrorCode
PH_TEMPERATURE_SENSOR_ERROR: PHErrorCode

class SensorBoardPHInfo(_message.Message):
    __slots__ = ("ph_value", "voltage", "temperature", "state", "error_code")
    PH_VALUE_FIELD_NUMBER: _ClassVar[int]
    VOLTAGE_FIELD_NUMBER: _ClassVar[int]
    TEMPERATURE_FIELD_NUMBER: _ClassVar[int]
    STATE_FIELD_NUMBER: _ClassVar[int]
    ERROR_CODE_FIELD_NUMBER: _ClassVar[int]
    ph_value: float
    voltage: float
    temperature: float
    state: _sensor_pb2.SensorState
    error_code: PHErrorCode
    def __init__(self, ph_value: _Optional[float] = ..., voltage: _Optional[float] = ..., temperature: _Optional[float] = ..., state: _Optional[_Union[_sensor_pb2.SensorState, int, str]] = ..., error_code: _Optional[_Union[PHErrorCode, int, str]] = ...) -> None: ...
