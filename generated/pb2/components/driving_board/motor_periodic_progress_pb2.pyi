# Generated from components/driving_board/motor_periodic_progress.proto; do not edit.
# Regenerate with: roverlink generate
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from typing import ClassVar as _ClassVar, Optional as _Optional

DESCRIPTOR: _descriptor.FileDescriptor

class DrivingBoardMotorPeriodicProgress(_message.Message):
    __slots__ = ("distance_left",)
    DISTANCE_LEFT_FIELD_NUMBER: _ClassVar[int]
    distance_left: float
    def __init__(self, distance_left: _Optional[float] = ...) -> None: ...
