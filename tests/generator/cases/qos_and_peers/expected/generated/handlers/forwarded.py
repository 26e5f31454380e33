# Generated from mapping.yaml (row forwarded) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""forwarded (7): G to rover/msg/G on forwarded."""

from __future__ import annotations

from generated.messages import G
from generated.pb2 import all_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(G)


class ForwardedHandler(Handler[all_pb2.G, G]):
    """G to the topic forwarded."""

    route = Route(
        number=7,
        name="forwarded",
        topic="forwarded",
        direction="arm_to_ros",
        forward=("base",),
    )
    payload_type = all_pb2.G
    message_type = G

    @staticmethod
    def to_ros(payload: all_pb2.G) -> G:
        """The message that says what the payload says."""
        return G(x=payload.x)

    @staticmethod
    def from_ros(message: G) -> all_pb2.G:
        """The payload that says what the message says."""
        return all_pb2.G(x=message.x)

    def pack(self, payload: all_pb2.G) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.x)
