# Generated from components/basestation/control_mode.proto; do not edit.
# Regenerate with: roverlink generate
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class ControlMode(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    MODE_MANUAL: _ClassVar[ControlMode]
    MODE_AUTO: _ClassVar[ControlMode]
MODE_MANUAL: ControlMode
MODE_AUTO: ControlMode

class BasestationControlMode(_message.Message):
    __slots__ = ("mode",)
    MODE_FIELD_NUMBER: _ClassVar[int]
    mode: ControlMode
    def __init__(self, mode: _Optional[_Union[ControlMode, int, str]] = ...) -> None: ...
