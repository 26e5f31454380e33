# Generated from components/driving_board/motor_msg.proto; do not edit.
# Regenerate with: roverlink generate
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from typing import ClassVar as _ClassVar, Optional as _Optional

DESCRIPTOR: _descriptor.FileDescriptor

class DrivingBoardMotorMessage(_message.Message):
    __slots__ = ("distance_to_go", "turning_radius")
    DISTANCE_TO_GO_FIELD_NUMBER: _ClassVar[int]
    TURNING_RADIUS_FIELD_NUMBER: _ClassVar[int]
    distance_to_go: float
    turning_radius: float
    def __init__(self, distance_to_go: _Optional[float] = ..., turning_radius: _Optional[float] = ...) -> None: ...
