# Generated from mapping.yaml (row spread) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""spread (8): H to rover/msg/H on spread."""

from __future__ import annotations

from generated.messages import H
from generated.pb2 import all_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(H)


class SpreadHandler(Handler[all_pb2.H, H]):
    """H to the topic spread."""

    route = Route(
        number=8,
        name="spread",
        topic="spread",
        direction="arm_to_ros",
        forward=("zeta", "base"),
    )
    payload_type = all_pb2.H
    message_type = H

    @staticmethod
    def to_ros(payload: all_pb2.H) -> H:
        """The message that says what the payload says."""
        return H(x=payload.x)

    @staticmethod
    def from_ros(message: H) -> all_pb2.H:
        """The payload that says what the message says."""
        return all_pb2.H(x=message.x)

    def pack(self, payload: all_pb2.H) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.x)
