# Generated from components/arm_board/movement_software_feedback.proto; do not edit.
# Regenerate with: roverlink generate
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class ArmBoardActualPositions(_message.Message):
    __slots__ = ("jaw_open", "jaw_actual_position", "base_actual_position", "stepper_top_actual_position", "stepper_bottom_actual_position", "gripper_rotation_actual_position", "gripper_pitch_actual_position")
    JAW_OPEN_FIELD_NUMBER: _ClassVar[int]
    JAW_ACTUAL_POSITION_FIELD_NUMBER: _ClassVar[int]
    BASE_ACTUAL_POSITION_FIELD_NUMBER: _ClassVar[int]
    STEPPER_TOP_ACTUAL_POSITION_FIELD_NUMBER: _ClassVar[int]
    STEPPER_BOTTOM_ACTUAL_POSITION_FIELD_NUMBER: _ClassVar[int]
    GRIPPER_ROTATION_ACTUAL_POSITION_FIELD_NUMBER: _ClassVar[int]
    GRIPPER_PITCH_ACTUAL_POSITION_FIELD_NUMBER: _ClassVar[int]
    jaw_open: bool
    jaw_actual_position: float
    base_actual_position: float
    stepper_top_actual_position: float
    stepper_bottom_actual_position: float
    gripper_rotation_actual_position: float
    gripper_pitch_actual_position: float
    def __init__(self, jaw_open: _Optional[bool] = ..., jaw_actual_position: _Optional[float] = ..., base_actual_position: _Optional[float] = ..., stepper_top_actual_position: _Optional[float] = ..., stepper_bottom_actual_position: _Optional[float] = ..., gripper_rotation_actual_position: _Optional[float] = ..., gripper_pitch_actual_position: _Optional[float] = ...) -> None: ...

class ArmBoardMovementFeedback(_message.Message):
    __slots__ = ("arm_error",)
    class ArmError(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
        __slots__ = ()
        POINT_NOT_IN_RANGE: _ClassVar[ArmBoardMovementFeedback.ArmError]
        OBSTRUCTION: _ClassVar[ArmBoardMovementFeedback.ArmError]
        CALIBRATION: _ClassVar[ArmBoardMovementFeedback.ArmError]
        MOTOR_MALFUNCTION: _ClassVar[ArmBoardMovementFeedback.ArmError]
        ALL_OK: _ClassVar[ArmBoardMovementFeedback.ArmError]
    POINT_NOT_IN_RANGE: ArmBoardMovementFeedback.ArmError
    OBSTRUCTION: ArmBoardMovementFeedback.ArmError
    CALIBRATION: ArmBoardMovementFeedback.ArmError
    MOTOR_MALFUNCTION: ArmBoardMovementFeedback.ArmError
    ALL_OK: ArmBoardMovementFeedback.ArmError
    ARM_ERROR_FIELD_NUMBER: _ClassVar[int]
    arm_error: ArmBoardMovementFeedback.ArmError
    def __init__(self, arm_error: _Optional[_Union[ArmBoardMovementFeedback.ArmError, int, str]] = ...) -> None: ...
