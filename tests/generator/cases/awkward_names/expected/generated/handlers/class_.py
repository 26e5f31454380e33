# Generated from mapping.yaml (row class) and awkward.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row class: Class and rover/msg/Class."""

from __future__ import annotations

from generated.messages import Class
from generated.pb2 import awkward_pb2
from roverlink.runtime.core.handler import Handler, Route


class ClassHandler(Handler[awkward_pb2.Class, Class]):
    """Class as rover/msg/Class.

    Number 1 of the envelope, board_to_ros, topic class.
    """

    route = Route(
        number=1,
        name="class",
        topic="class",
        direction="board_to_ros",
    )
    payload_type = awkward_pb2.Class
    message_type = Class

    @staticmethod
    def to_ros(payload: awkward_pb2.Class) -> Class:
        """Convert Class to rover/msg/Class."""
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
        """Convert rover/msg/Class to Class."""
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
