# Generated from components/arm_board/movement_control_in.proto; do not edit.
# Regenerate with: roverlink generate
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from typing import ClassVar as _ClassVar, Optional as _Optional

DESCRIPTOR: _descriptor.FileDescriptor

class ArmBoardControlSignals(_message.Message):
    __slots__ = ("control_gripper_rotation", "control_gripper_pitch", "control_base", "control_jaw", "stepper_top_ena", "stepper_top_rev", "stepper_bottom_ena", "stepper_bottom_rev")
    CONTROL_GRIPPER_ROTATION_FIELD_NUMBER: _ClassVar[int]
    CONTROL_GRIPPER_PITCH_FIELD_NUMBER: _ClassVar[int]
    CONTROL_BASE_FIELD_NUMBER: _ClassVar[int]
    CONTROL_JAW_FIELD_NUMBER: _ClassVar[int]
    STEPPER_TOP_ENA_FIELD_NUMBER: _ClassVar[int]
    STEPPER_TOP_REV_FIELD_NUMBER: _ClassVar[int]
    STEPPER_BOTTOM_ENA_FIELD_NUMBER: _ClassVar[int]
    STEPPER_BOTTOM_REV_FIELD_NUMBER: _ClassVar[int]
    control_gripper_rotation: float
    control_gripper_pitch: float
    control_base: float
    control_jaw: float
    stepper_top_ena: bool
    stepper_top_rev: bool
    stepper_bottom_ena: bool
    stepper_bottom_rev: bool
    def __init__(self, control_gripper_rotation: _Optional[float] = ..., control_gripper_pitch: _Optional[float] = ..., control_base: _Optional[float] = ..., control_jaw: _Optional[float] = ..., stepper_top_ena: _Optional[bool] = ..., stepper_top_rev: _Optional[bool] = ..., stepper_bottom_ena: _Optional[bool] = ..., stepper_bottom_rev: _Optional[bool] = ...) -> None: ...
