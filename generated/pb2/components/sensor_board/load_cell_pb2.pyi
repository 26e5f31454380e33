# Generated from components/sensor_board/load_cell.proto; do not edit.
# Regenerate with: roverlink generate
from generated.pb2.components.sensor_board import sensor_pb2 as _sensor_pb2
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class LoadCellErrorCode(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    LOAD_CELL_NO_ERROR: _ClassVar[LoadCellErrorCode]
    LOAD_CELL_COMMUNICATION_FAILURE: _ClassVar[LoadCellErrorCode]
    LOAD_CELL_OUT_OF_RANGE: _ClassVar[LoadCellErrorCode]
    LOAD_CELL_CALIBRATION_REQUIRED: _ClassVar[LoadCellErrorCode]
    LOAD_CELL_INVALID_DATA: _ClassVar[LoadCellErrorCode]
    LOAD_CELL_SENSOR_FAULT: _ClassVar[LoadCellErrorCode]
LOAD_CELL_NO_ERROR: LoadCellErrorCode
LOAD_CELL_COMMUNICATION_FAILURE: LoadCellErrorCode
LOAD_CELL_OUT_OF_RANGE: LoadCellErrorCode
LOAD_CELL_CALIBRATION_REQUIRED: LoadCellErrorCode
LOAD_CELL_INVALID_DATA: LoadCellErrorCode
LOAD_CELL_SENSOR_FAULT: LoadCellErrorCode

class SensorBoardLoadCellInfo(_message.Message):
    __slots__ = ("sensor_index", "force_newtons", "mass_grams", "raw_counts", "is_calibrated", "scale_newtons_per_count", "tare_offset_counts", "state", "error_code")
    SENSOR_INDEX_FIELD_NUMBER: _ClassVar[int]
    FORCE_NEWTONS_FIELD_NUMBER: _ClassVar[int]
    MASS_GRAMS_FIELD_NUMBER: _ClassVar[int]
    RAW_COUNTS_FIELD_NUMBER: _ClassVar[int]
    IS_CALIBRATED_FIELD_NUMBER: _ClassVar[int]
    SCALE_NEWTONS_PER_COUNT_FIELD_NUMBER: _ClassVar[int]
    TARE_OFFSET_COUNTS_FIELD_NUMBER: _ClassVar[int]
    STATE_FIELD_NUMBER: _ClassVar[int]
    ERROR_CODE_FIELD_NUMBER: _ClassVar[int]
    sensor_index: int
    force_newtons: float
    mass_grams: float
    raw_counts: int
    is_calibrated: bool
    scale_newtons_per_count: float
    tare_offset_counts: int
    state: _sensor_pb2.SensorState
    error_code: LoadCellErrorCode
    def __init__(self, sensor_index: _Optional[int] = ..., force_newtons: _Optional[float] = ..., mass_grams: _Optional[float] = ..., raw_counts: _Optional[int] = ..., is_calibrated: _Optional[bool] = ..., scale_newtons_per_count: _Optional[float] = ..., tare_offset_counts: _Optional[int] = ..., state: _Optional[_Union[_sensor_pb2.SensorState, int, str]] = ..., error_code: _Optional[_Union[LoadCellErrorCode, int, str]] = ...) -> None: ...
