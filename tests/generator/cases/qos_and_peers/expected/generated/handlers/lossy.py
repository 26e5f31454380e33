# Generated from mapping.yaml (row lossy) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""lossy (3): C to rover/msg/C on lossy."""

from __future__ import annotations

from generated.messages import C
from generated.pb2 import all_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Qos, Route

_CDR = cdr.fixed_layout(C)


class LossyHandler(Handler[all_pb2.C, C]):
    """C to the topic lossy."""

    route = Route(
        number=3,
        name="lossy",
        topic="lossy",
        direction="arm_to_ros",
        qos=Qos(reliability="best_effort", depth=1),
    )
    payload_type = all_pb2.C
    message_type = C

    @staticmethod
    def to_ros(payload: all_pb2.C) -> C:
        """The message that says what the payload says."""
        return C(x=payload.x)

    @staticmethod
    def from_ros(message: C) -> all_pb2.C:
        """The payload that says what the message says."""
        return all_pb2.C(x=message.x)

    def pack(self, payload: all_pb2.C) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.x)
