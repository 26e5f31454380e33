# Generated from mapping.yaml (row new) and new.proto; do not edit.
# Regenerate with: roverlink generate
"""new (2): New to rover/msg/New on new."""

from __future__ import annotations

from generated.conversions import new2
from generated.messages import New
from generated.pb2 import new_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(New)


class NewHandler(Handler[new_pb2.New, New]):
    """New to the topic new."""

    route = Route(number=2, name="new", topic="new", direction="board_to_ros")
    payload_type = new_pb2.New
    message_type = New

    @staticmethod
    def to_ros(payload: new_pb2.New) -> New:
        """The message that says what the payload says."""
        return New(
            has_explicit_field=payload.HasField("explicit"),
            explicit_field=payload.explicit,
            implicit=payload.implicit,
            nested=new2.to_ros(payload.nested),
        )

    @staticmethod
    def from_ros(message: New) -> new_pb2.New:
        """The payload that says what the message says."""
        return new_pb2.New(
            explicit=message.explicit_field if message.has_explicit_field else None,
            implicit=message.implicit,
            nested=new2.from_ros(message.nested),
        )

    def pack(self, payload: new_pb2.New) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        nested = payload.nested
        return _CDR.pack(
            cdr.LITTLE_ENDIAN,
            payload.HasField("explicit"),
            payload.explicit,
            payload.implicit,
            nested.HasField("x"),
            nested.x,
        )
