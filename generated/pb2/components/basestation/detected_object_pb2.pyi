# Generated from components/basestation/detected_object.proto; do not edit.
# Regenerate with: roverlink generate
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class DetectedObjectType(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    OBJECT_UNKNOWN: _ClassVar[DetectedObjectType]
    OBJECT_ROCK: _ClassVar[DetectedObjectType]
    OBJECT_REGOLITH: _ClassVar[DetectedObjectType]
    OBJECT_MAIN_SWITCH: _ClassVar[DetectedObjectType]
    OBJECT_SWITCH: _ClassVar[DetectedObjectType]
    OBJECT_ROTARY_SWITCH: _ClassVar[DetectedObjectType]
    OBJECT_ROTARY_POWER_SWITCH: _ClassVar[DetectedObjectType]
    OBJECT_SOCKET: _ClassVar[DetectedObjectType]
    OBJECT_ELECTROMAGNET: _ClassVar[DetectedObjectType]
    OBJECT_PLATE: _ClassVar[DetectedObjectType]
    OBJECT_CABLE: _ClassVar[DetectedObjectType]
OBJECT_UNKNOWN: DetectedObjectType
OBJECT_ROCK: DetectedObjectType
OBJECT_REGOLITH: DetectedObjectType
OBJECT_MAIN_SWITCH: DetectedObjectType
OBJECT_SWITCH: DetectedObjectType
OBJECT_ROTARY_SWITCH: DetectedObjectType
OBJECT_ROTARY_POWER_SWITCH: DetectedObjectType
OBJECT_SOCKET: DetectedObjectType
OBJECT_ELECTROMAGNET: DetectedObjectType
OBJECT_PLATE: DetectedObjectType
OBJECT_CABLE: DetectedObjectType

class BasestationDetectedObject(_message.Message):
    __slots__ = ("frame_id", "total_count", "index", "id", "type", "bbox", "confidence")
    FRAME_ID_FIELD_NUMBER: _ClassVar[int]
    TOTAL_COUNT_FIELD_NUMBER: _ClassVar[int]
    INDEX_FIELD_NUMBER: _ClassVar[int]
    ID_FIELD_NUMBER: _ClassVar[int]
    TYPE_FIELD_NUMBER: _ClassVar[int]
    BBOX_FIELD_NUMBER: _ClassVar[int]
    CONFIDENCE_FIELD_NUMBER: _ClassVar[int]
    frame_id: int
    total_count: int
    index: int
    id: int
    type: DetectedObjectType
    bbox: BoundingBox
    confidence: float
    def __init__(self, frame_id: _Optional[int] = ..., total_count: _Optional[int] = ..., index: _Optional[int] = ..., id: _Optional[int] = ..., type: _Optional[_Union[DetectedObjectType, int, str]] = ..., bbox: _Optional[_Union[BoundingBox, _Mapping]] = ..., confidence: _Optional[float] = ...) -> None: ...

class BoundingBox(_message.Message):
    __slots__ = ("x", "y", "width", "height")
    X_FIELD_NUMBER: _ClassVar[int]
    Y_FIELD_NUMBER: _ClassVar[int]
    WIDTH_FIELD_NUMBER: _ClassVar[int]
    HEIGHT_FIELD_NUMBER: _ClassVar[int]
    x: int
    y: int
    width: int
    height: int
    def __init__(self, x: _Optional[int] = ..., y: _Optional[int] = ..., width: _Optional[int] = ..., height: _Optional[int] = ...) -> None: ...
