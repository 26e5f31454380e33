# Generated from components/sensor_board/gps_sensor.proto; do not edit.
# Regenerate with: roverlink generate
from generated.pb2.components.sensor_board import sensor_pb2 as _sensor_pb2
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class GPSErrorCode(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    GPS_NO_ERROR: _ClassVar[GPSErrorCode]
    GPS_COMMUNICATION_FAILURE: _ClassVar[GPSErrorCode]
    GPS_INVALID_DATA: _ClassVar[GPSErrorCode]
    GPS_ANTENNA_FAULT: _ClassVar[GPSErrorCode]
    GPS_LOW_SIGNAL_QUALITY: _ClassVar[GPSErrorCode]

class GPSFixQuality(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    NO_FIX: _ClassVar[GPSFixQuality]
    GPS_FIX: _ClassVar[GPSFixQuality]
    DGPS_FIX: _ClassVar[GPSFixQuality]
    PPS_FIX: _ClassVar[GPSFixQuality]
    RTK_FIX: _ClassVar[GPSFixQuality]
    RTK_FLOAT: _ClassVar[GPSFixQuality]
GPS_NO_ERROR: GPSErrorCode
GPS_COMMUNICATION_FAILURE: GPSErrorCode
GPS_INVALID_DATA: GPSErrorCode
GPS_ANTENNA_FAULT: GPSErrorCode
GPS_LOW_SIGNAL_QUALITY: GPSErrorCode
NO_FIX: GPSFixQuality
GPS_FIX: GPSFixQuality
DGPS_FIX: GPSFixQuality
PPS_FIX: GPSFixQuality
RTK_FIX: GPSFixQuality
RTK_FLOAT: GPSFixQuality

class SensorBoardGPSInfo(_message.Message):
    __slots__ = ("latitude", "longitude", "altitude", "speed", "heading", "hdop", "vdop", "satellites", "fix_quality", "state", "error_code", "utc_timestamp")
    LATITUDE_FIELD_NUMBER: _ClassVar[int]
    LONGITUDE_FIELD_NUMBER: _ClassVar[int]
    ALTITUDE_FIELD_NUMBER: _ClassVar[int]
    SPEED_FIELD_NUMBER: _ClassVar[int]
    HEADING_FIELD_NUMBER: _ClassVar[int]
    HDOP_FIELD_NUMBER: _ClassVar[int]
    VDOP_FIELD_NUMBER: _ClassVar[int]
    SATELLITES_FIELD_NUMBER: _ClassVar[int]
    FIX_QUALITY_FIELD_NUMBER: _ClassVar[int]
    STATE_FIELD_NUMBER: _ClassVar[int]
    ERROR_CODE_FIELD_NUMBER: _ClassVar[int]
    UTC_TIMESTAMP_FIELD_NUMBER: _ClassVar[int]
    latitude: float
    longitude: float
    altitude: float
    speed: float
    heading: float
    hdop: float
    vdop: float
    satellites: int
    fix_quality: GPSFixQuality
    state: _sensor_pb2.SensorState
    error_code: GPSErrorCode
    utc_timestamp: int
    def __init__(self, latitude: _Optional[float] = ..., longitude: _Optional[float] = ..., altitude: _Optional[float] = ..., speed: _Optional[float] = ..., heading: _Optional[float] = ..., hdop: _Optional[float] = ..., vdop: _Optional[float] = ..., satellites: _Optional[int] = ..., fix_quality: _Optional[_Union[GPSFixQuality, int, str]] = ..., state: _Optional[_Union[_sensor_pb2.SensorState, int, str]] = ..., error_code: _Optional[_Union[GPSErrorCode, int, str]] = ..., utc_timestamp: _Optional[int] = ...) -> None: ...
