# Generated from components/arm_board/movement_software_target.proto; do not edit.
# Regenerate with: roverlink generate
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from typing import ClassVar as _ClassVar, Optional as _Optional

DESCRIPTOR: _descriptor.FileDescriptor

class ArmBoardObstructions(_message.Message):
    __slots__ = ("obstructions_list",)
    OBSTRUCTIONS_LIST_FIELD_NUMBER: _ClassVar[int]
    obstructions_list: float
    def __init__(self, obstructions_list: _Optional[float] = ...) -> None: ...

class ArmBoardTargetMovement(_message.Message):
    __slots__ = ("target_x", "target_y", "target_z", "rotation_angle", "open_jaw", "final_gripper_angle")
    TARGET_X_FIELD_NUMBER: _ClassVar[int]
    TARGET_Y_FIELD_NUMBER: _ClassVar[int]
    TARGET_Z_FIELD_NUMBER: _ClassVar[int]
    ROTATION_ANGLE_FIELD_NUMBER: _ClassVar[int]
    OPEN_JAW_FIELD_NUMBER: _ClassVar[int]
    FINAL_GRIPPER_ANGLE_FIELD_NUMBER: _ClassVar[int]
    target_x: float
    target_y: float
    target_z: float
    rotation_angle: float
    open_jaw: bool
    final_gripper_angle: float
    def __init__(self, target_x: _Optional[float] = ..., target_y: _Optional[float] = ..., target_z: _Optional[float] = ..., rotation_angle: _Optional[float] = ..., open_jaw: _Optional[bool] = ..., final_gripper_angle: _Optional[float] = ...) -> None: ...
