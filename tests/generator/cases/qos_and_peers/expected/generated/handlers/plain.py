# Generated from mapping.yaml (row plain) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""plain (1): A to rover/msg/A on plain."""

from __future__ import annotations

from generated.messages import A
from generated.pb2 import all_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(A)


class PlainHandler(Handler[all_pb2.A, A]):
    """A to the topic plain."""

    route = Route(number=1, name="plain", topic="plain", direction="arm_to_ros")
    payload_type = all_pb2.A
    message_type = A

    @staticmethod
    def to_ros(payload: all_pb2.A) -> A:
        """The message that says what the payload says."""
        return A(x=payload.x)

    @staticmethod
    def from_ros(message: A) -> all_pb2.A:
        """The payload that says what the message says."""
        return all_pb2.A(x=message.x)

    def pack(self, payload: all_pb2.A) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.x)
