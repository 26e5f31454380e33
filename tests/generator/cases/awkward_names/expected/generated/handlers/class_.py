# Generated from mapping.yaml (row class) and awkward.proto; do not edit.
# Regenerate with: roverlink generate
"""class (1): Class to rover/msg/Class on class."""

from __future__ import annotations

from generated.messages import Class
from generated.pb2 import awkward_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(Class)


class ClassHandler(Handler[awkward_pb2.Class, Class]):
    """Class to the topic class."""

    route = Route(number=1, name="class", topic="class", direction="board_to_ros")
    payload_type = awkward_pb2.Class
    message_type = Class

    @staticmethod
    def to_ros(payload: awkward_pb2.Class) -> Class:
        """The message that says what the payload says."""
        return Class(
            l=payload.l,
            self=payload.self,
            cls=payload.cls,
            payload=payload.payload,
            message=payload.message,
            item=payload.item,
            cdr=payload.cdr,
            type=payload.type,
            id=payload.id,
            len=payload.len,
            object=payload.object,
            field=payload.field,
            dataclass=payload.dataclass,
            print=payload.print,
            match=payload.match,
        )

    @staticmethod
    def from_ros(message: Class) -> awkward_pb2.Class:
        """The payload that says what the message says."""
        return awkward_pb2.Class(
            l=message.l,
            self=message.self,
            cls=message.cls,
            payload=message.payload,
            message=message.message,
            item=message.item,
            cdr=message.cdr,
            type=message.type,
            id=message.id,
            len=message.len,
            object=message.object,
            field=message.field,
            dataclass=message.dataclass,
            print=message.print,
            match=message.match,
        )

    def pack(self, payload: awkward_pb2.Class) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(
            cdr.LITTLE_ENDIAN,
            payload.l,
            payload.self,
            payload.cls,
            payload.payload,
            payload.message,
            payload.item,
            payload.cdr,
            payload.type,
            payload.id,
            payload.len,
            payload.object,
            payload.field,
            payload.dataclass,
            payload.print,
            payload.match,
        )
