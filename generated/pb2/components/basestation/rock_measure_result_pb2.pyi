# Generated from components/basestation/rock_measure_result.proto; do not edit.
# Regenerate with: roverlink generate
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class RockMeasureFailure(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    ROCK_MEASURE_FAILURE_NONE: _ClassVar[RockMeasureFailure]
    ROCK_MEASURE_FAILURE_NO_IMAGE: _ClassVar[RockMeasureFailure]
    ROCK_MEASURE_FAILURE_OUTSIDE_IMAGE: _ClassVar[RockMeasureFailure]
    ROCK_MEASURE_FAILURE_SHORT_LINE: _ClassVar[RockMeasureFailure]
    ROCK_MEASURE_FAILURE_NOT_ALIGNED: _ClassVar[RockMeasureFailure]
    ROCK_MEASURE_FAILURE_LITTLE_DEPTH: _ClassVar[RockMeasureFailure]
    ROCK_MEASURE_FAILURE_NO_PLANE: _ClassVar[RockMeasureFailure]
    ROCK_MEASURE_FAILURE_NO_ROCK: _ClassVar[RockMeasureFailure]
    ROCK_MEASURE_FAILURE_CUT_OFF: _ClassVar[RockMeasureFailure]
    ROCK_MEASURE_FAILURE_LINE_MISMATCH: _ClassVar[RockMeasureFailure]
ROCK_MEASURE_FAILURE_NONE: RockMeasureFailure
ROCK_MEASURE_FAILURE_NO_IMAGE: RockMeasureFailure
ROCK_MEASURE_FAILURE_OUTSIDE_IMAGE: RockMeasureFailure
ROCK_MEASURE_FAILURE_SHORT_LINE: RockMeasureFailure
ROCK_MEASURE_FAILURE_NOT_ALIGNED: RockMeasureFailure
ROCK_MEASURE_FAILURE_LITTLE_DEPTH: RockMeasureFailure
ROCK_MEASURE_FAILURE_NO_PLANE: RockMeasureFailure
ROCK_MEASURE_FAILURE_NO_ROCK: RockMeasureFailure
ROCK_MEASURE_FAILURE_CUT_OFF: RockMeasureFailure
ROCK_MEASURE_FAILURE_LINE_MISMATCH: RockMeasureFailure

class BasestationRockMeasureResult(_message.Message):
    __slots__ = ("length_cm", "width_cm", "failure", "length_sigma_cm", "width_sigma_cm")
    LENGTH_CM_FIELD_NUMBER: _ClassVar[int]
    WIDTH_CM_FIELD_NUMBER: _ClassVar[int]
    FAILURE_FIELD_NUMBER: _ClassVar[int]
    LENGTH_SIGMA_CM_FIELD_NUMBER: _ClassVar[int]
    WIDTH_SIGMA_CM_FIELD_NUMBER: _ClassVar[int]
    length_cm: float
    width_cm: float
    failure: RockMeasureFailure
    length_sigma_cm: float
    width_sigma_cm: float
    def __init__(self, length_cm: _Optional[float] = ..., width_cm: _Optional[float] = ..., failure: _Optional[_Union[RockMeasureFailure, int, str]] = ..., length_sigma_cm: _Optional[float] = ..., width_sigma_cm: _Optional[float] = ...) -> None: ...
