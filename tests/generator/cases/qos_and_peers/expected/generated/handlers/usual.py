# Generated from mapping.yaml (row usual) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""usual (6): F to rover/msg/F on usual."""

from __future__ import annotations

from generated.messages import F
from generated.pb2 import all_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(F)


class UsualHandler(Handler[all_pb2.F, F]):
    """F to the topic usual."""

    route = Route(number=6, name="usual", topic="usual", direction="base_to_ros")
    payload_type = all_pb2.F
    message_type = F

    @staticmethod
    def to_ros(payload: all_pb2.F) -> F:
        """The message that says what the payload says."""
        return F(x=payload.x)

    @staticmethod
    def from_ros(message: F) -> all_pb2.F:
        """The payload that says what the message says."""
        return all_pb2.F(x=message.x)

    def pack(self, payload: all_pb2.F) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.x)
