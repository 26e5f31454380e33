# Generated from mapping.yaml (row queued) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""queued (2): B to rover/msg/B on queued."""

from __future__ import annotations

from generated.messages import B
from generated.pb2 import all_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Qos, Route

_CDR = cdr.fixed_layout(B)


class QueuedHandler(Handler[all_pb2.B, B]):
    """B to the topic queued."""

    route = Route(
        number=2,
        name="queued",
        topic="queued",
        direction="arm_to_ros",
        qos=Qos(depth=50),
    )
    payload_type = all_pb2.B
    message_type = B

    @staticmethod
    def to_ros(payload: all_pb2.B) -> B:
        """The message that says what the payload says."""
        return B(x=payload.x)

    @staticmethod
    def from_ros(message: B) -> all_pb2.B:
        """The payload that says what the message says."""
        return all_pb2.B(x=message.x)

    def pack(self, payload: all_pb2.B) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.x)
