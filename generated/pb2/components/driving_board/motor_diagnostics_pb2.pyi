# Generated from components/driving_board/motor_diagnostics.proto; do not edit.
# Regenerate with: roverlink generate
from generated.pb2.components.common import motor_pb2 as _motor_pb2
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class DrivingBoardDiagnostics(_message.Message):
    __slots__ = ("state", "front_left_motor", "middle_left_motor", "back_left_motor", "front_right_motor", "middle_right_motor", "back_right_motor", "steering_front_left_motor", "steering_back_left_motor", "steering_front_right_motor", "steering_back_right_motor")
    class State(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
        __slots__ = ()
        IDLE: _ClassVar[DrivingBoardDiagnostics.State]
        OPERATING: _ClassVar[DrivingBoardDiagnostics.State]
        CALIBRATING: _ClassVar[DrivingBoardDiagnostics.State]
        ERROR: _ClassVar[DrivingBoardDiagnostics.State]
    IDLE: DrivingBoardDiagnostics.State
    OPERATING: DrivingBoardDiagnostics.State
    CALIBRATING: DrivingBoardDiagnostics.State
    ERROR: DrivingBoardDiagnostics.State
    STATE_FIELD_NUMBER: _ClassVar[int]
    FRONT_LEFT_MOTOR_FIELD_NUMBER: _ClassVar[int]
    MIDDLE_LEFT_MOTOR_FIELD_NUMBER: _ClassVar[int]
    BACK_LEFT_MOTOR_FIELD_NUMBER: _ClassVar[int]
    FRONT_RIGHT_MOTOR_FIELD_NUMBER: _ClassVar[int]
    MIDDLE_RIGHT_MOTOR_FIELD_NUMBER: _ClassVar[int]
    BACK_RIGHT_MOTOR_FIELD_NUMBER: _ClassVar[int]
    STEERING_FRONT_LEFT_MOTOR_FIELD_NUMBER: _ClassVar[int]
    STEERING_BACK_LEFT_MOTOR_FIELD_NUMBER: _ClassVar[int]
    STEERING_FRONT_RIGHT_MOTOR_FIELD_NUMBER: _ClassVar[int]
    STEERING_BACK_RIGHT_MOTOR_FIELD_NUMBER: _ClassVar[int]
    state: DrivingBoardDiagnostics.State
    front_left_motor: _motor_pb2.MotorInformation
    middle_left_motor: _motor_pb2.MotorInformation
    back_left_motor: _motor_pb2.MotorInformation
    front_right_motor: _motor_pb2.MotorInformation
    middle_right_motor: _motor_pb2.MotorInformation
    back_right_motor: _motor_pb2.MotorInformation
    steering_front_left_motor: _motor_pb2.MotorInformation
    steering_back_left_motor: _motor_pb2.MotorInformation
    steering_front_right_motor: _motor_pb2.MotorInformation
    steering_back_right_motor: _motor_pb2.MotorInformation
    def __init__(self, state: _Optional[_Union[DrivingBoardDiagnostics.State, int, str]] = ..., front_left_motor: _Optional[_Union[_motor_pb2.MotorInformation, _Mapping]] = ..., middle_left_motor: _Optional[_Union[_motor_pb2.MotorInformation, _Mapping]] = ..., back_left_motor: _Optional[_Union[_motor_pb2.MotorInformation, _Mapping]] = ..., front_right_motor: _Optional[_Union[_motor_pb2.MotorInformation, _Mapping]] = ..., middle_right_motor: _Optional[_Union[_motor_pb2.MotorInformation, _Mapping]] = ..., back_right_motor: _Optional[_Union[_motor_pb2.MotorInformation, _Mapping]] = ..., steering_front_left_motor: _Optional[_Union[_motor_pb2.MotorInformation, _Mapping]] = ..., steering_back_left_motor: _Optional[_Union[_motor_pb2.MotorInformation, _Mapping]] = ..., steering_front_right_motor: _Optional[_Union[_motor_pb2.MotorInformation, _Mapping]] = ..., steering_back_right_motor: _Optional[_Union[_motor_pb2.MotorInformation, _Mapping]] = ...) -> None: ...
