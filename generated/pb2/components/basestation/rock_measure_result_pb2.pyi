# Generated from components/basestation/rock_measure_result.proto; do not edit.
# Regenerate with: roverlink generate
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from typing import ClassVar as _ClassVar, Optional as _Optional

DESCRIPTOR: _descriptor.FileDescriptor

class BasestationRockMeasureResult(_message.Message):
    __slots__ = ("length_cm", "width_cm")
    LENGTH_CM_FIELD_NUMBER: _ClassVar[int]
    WIDTH_CM_FIELD_NUMBER: _ClassVar[int]
    length_cm: float
    width_cm: float
    def __init__(self, length_cm: _Optional[float] = ..., width_cm: _Optional[float] = ...) -> None: ...
