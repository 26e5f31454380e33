# Generated from components/sensor_board/diagnostics.proto; do not edit.
# Regenerate with: roverlink generate
from generated.pb2.components.sensor_board import gps_sensor_pb2 as _gps_sensor_pb2
from generated.pb2.components.sensor_board import imu_sensor_pb2 as _imu_sensor_pb2
from generated.pb2.components.sensor_board import load_cell_pb2 as _load_cell_pb2
from generated.pb2.components.sensor_board import ph_sensor_pb2 as _ph_sensor_pb2
from generated.pb2.components.sensor_board import pressure_sensor_pb2 as _pressure_sensor_pb2
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class SensorBoardDiagnostics(_message.Message):
    __slots__ = ("state", "ph_sensor", "imu_sensor", "board_temperature", "board_voltage", "gps_sensor_1", "load_cell", "pressure_sensor")
    class State(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
        __slots__ = ()
        IDLE: _ClassVar[SensorBoardDiagnostics.State]
        OPERATING: _ClassVar[SensorBoardDiagnostics.State]
        CALIBRATING: _ClassVar[SensorBoardDiagnostics.State]
        ERROR: _ClassVar[SensorBoardDiagnostics.State]
    IDLE: SensorBoardDiagnostics.State
    OPERATING: SensorBoardDiagnostics.State
    CALIBRATING: SensorBoardDiagnostics.State
    ERROR: SensorBoardDiagnostics.State
    STATE_FIELD_NUMBER: _ClassVar[int]
    PH_SENSOR_FIELD_NUMBER: _ClassVar[int]
    IMU_SENSOR_FIELD_NUMBER: _ClassVar[int]
    BOARD_TEMPERATURE_FIELD_NUMBER: _ClassVar[int]
    BOARD_VOLTAGE_FIELD_NUMBER: _ClassVar[int]
    GPS_SENSOR_1_FIELD_NUMBER: _ClassVar[int]
    LOAD_CELL_FIELD_NUMBER: _ClassVar[int]
    PRESSURE_SENSOR_FIELD_NUMBER: _ClassVar[int]
    state: SensorBoardDiagnostics.State
    ph_sensor: _ph_sensor_pb2.SensorBoardPHInfo
    imu_sensor: _imu_sensor_pb2.SensorBoardIMUInfo
    board_temperature: float
    board_voltage: float
    gps_sensor_1: _gps_sensor_pb2.SensorBoardGPSInfo
    load_cell: _load_cell_pb2.SensorBoardLoadCellInfo
    pressure_sensor: _pressure_sensor_pb2.SensorBoardPressureInfo
    def __init__(self, state: _Optional[_Union[SensorBoardDiagnostics.State, int, str]] = ..., ph_sensor: _Optional[_Union[_ph_sensor_pb2.SensorBoardPHInfo, _Mapping]] = ..., imu_sensor: _Optional[_Union[_imu_sensor_pb2.SensorBoardIMUInfo, _Mapping]] = ..., board_temperature: _Optional[float] = ..., board_voltage: _Optional[float] = ..., gps_sensor_1: _Optional[_Union[_gps_sensor_pb2.SensorBoardGPSInfo, _Mapping]] = ..., load_cell: _Optional[_Union[_load_cell_pb2.SensorBoardLoadCellInfo, _Mapping]] = ..., pressure_sensor: _Optional[_Union[_pressure_sensor_pb2.SensorBoardPressureInfo, _Mapping]] = ...) -> None: ...
