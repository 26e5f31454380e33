# Generated from imu.proto; do not edit.
# Regenerate with: roverlink generate
from generated.pb2 import vector_pb2 as _vector_pb2
from generated.pb2 import chained_pb2 as _chained_pb2
from generated.pb2.deep import deep_pb2 as _deep_pb2
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union
from generated.pb2.vector_pb2 import Vector as Vector

DESCRIPTOR: _descriptor.FileDescriptor

class Imu(_message.Message):
    __slots__ = ("a", "deep")
    A_FIELD_NUMBER: _ClassVar[int]
    DEEP_FIELD_NUMBER: _ClassVar[int]
    a: _vector_pb2.Vector
    deep: _deep_pb2.Deep
    def __init__(self, a: _Optional[_Union[_vector_pb2.Vector, _Mapping]] = ..., deep: _Optional[_Union[_deep_pb2.Deep, _Mapping]] = ...) -> None: ...
