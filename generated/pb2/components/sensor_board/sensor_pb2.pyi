# Generated from components/sensor_board/sensor.proto; do not edit.
# Regenerate with: roverlink generate
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from typing import ClassVar as _ClassVar

DESCRIPTOR: _descriptor.FileDescriptor

class SensorState(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    SENSOR_IDLE: _ClassVar[SensorState]
    SENSOR_OPERATING: _ClassVar[SensorState]
    SENSOR_CALIBRATING: _ClassVar[SensorState]
    SENSOR_ERROR: _ClassVar[SensorState]
SENSOR_IDLE: SensorState
SENSOR_OPERATING: SensorState
SENSOR_CALIBRATING: SensorState
SENSOR_ERROR: SensorState
