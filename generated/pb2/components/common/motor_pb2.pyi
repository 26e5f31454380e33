# Generated from components/common/motor.proto; do not edit.
# Regenerate with: roverlink generate
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class MotorInformation(_message.Message):
    __slots__ = ("state", "motor_id", "rpm", "voltage", "encoder_angle")
    class State(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
        __slots__ = ()
        IDLE: _ClassVar[MotorInformation.State]
        OPERATING: _ClassVar[MotorInformation.State]
        CALIBRATING: _ClassVar[MotorInformation.State]
        ERROR: _ClassVar[MotorInformation.State]
    IDLE: MotorInformation.State
    OPERATING: MotorInformation.State
    CALIBRATING: MotorInformation.State
    ERROR: MotorInformation.State
    STATE_FIELD_NUMBER: _ClassVar[int]
    MOTOR_ID_FIELD_NUMBER: _ClassVar[int]
    RPM_FIELD_NUMBER: _ClassVar[int]
    VOLTAGE_FIELD_NUMBER: _ClassVar[int]
    ENCODER_ANGLE_FIELD_NUMBER: _ClassVar[int]
    state: MotorInformation.State
    motor_id: int
    rpm: float
    voltage: float
    encoder_angle: float
    def __init__(self, state: _Optional[_Union[MotorInformation.State, int, str]] = ..., motor_id: _Optional[int] = ..., rpm: _Optional[float] = ..., voltage: _Optional[float] = ..., encoder_angle: _Optional[float] = ...) -> None: ...
