# Generated from components/arm_board/motor_diagnostics.proto; do not edit.
# Regenerate with: roverlink generate
from generated.pb2.components.common import motor_pb2 as _motor_pb2
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class ArmBoardDiagnostics(_message.Message):
    __slots__ = ("gripper_rotation_motor", "gripper_pitch_motor", "base_motor", "top_motor", "bottom_motor", "jaw_motor", "state")
    class State(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
        __slots__ = ()
        IDLE: _ClassVar[ArmBoardDiagnostics.State]
        OPERATING: _ClassVar[ArmBoardDiagnostics.State]
        CALIBRATING: _ClassVar[ArmBoardDiagnostics.State]
        ERROR: _ClassVar[ArmBoardDiagnostics.State]
    IDLE: ArmBoardDiagnostics.State
    OPERATING: ArmBoardDiagnostics.State
    CALIBRATING: ArmBoardDiagnostics.State
    ERROR: ArmBoardDiagnostics.State
    GRIPPER_ROTATION_MOTOR_FIELD_NUMBER: _ClassVar[int]
    GRIPPER_PITCH_MOTOR_FIELD_NUMBER: _ClassVar[int]
    BASE_MOTOR_FIELD_NUMBER: _ClassVar[int]
    TOP_MOTOR_FIELD_NUMBER: _ClassVar[int]
    BOTTOM_MOTOR_FIELD_NUMBER: _ClassVar[int]
    JAW_MOTOR_FIELD_NUMBER: _ClassVar[int]
    STATE_FIELD_NUMBER: _ClassVar[int]
    gripper_rotation_motor: _motor_pb2.MotorInformation
    gripper_pitch_motor: _motor_pb2.MotorInformation
    base_motor: _motor_pb2.MotorInformation
    top_motor: _motor_pb2.MotorInformation
    bottom_motor: _motor_pb2.MotorInformation
    jaw_motor: _motor_pb2.MotorInformation
    state: ArmBoardDiagnostics.State
    def __init__(self, gripper_rotation_motor: _Optional[_Union[_motor_pb2.MotorInformation, _Mapping]] = ..., gripper_pitch_motor: _Optional[_Union[_motor_pb2.MotorInformation, _Mapping]] = ..., base_motor: _Optional[_Union[_motor_pb2.MotorInformation, _Mapping]] = ..., top_motor: _Optional[_Union[_motor_pb2.MotorInformation, _Mapping]] = ..., bottom_motor: _Optional[_Union[_motor_pb2.MotorInformation, _Mapping]] = ..., jaw_motor: _Optional[_Union[_motor_pb2.MotorInformation, _Mapping]] = ..., state: _Optional[_Union[ArmBoardDiagnostics.State, int, str]] = ...) -> None: ...
