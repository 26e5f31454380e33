# Generated from mapping.yaml (row forwarded) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row forwarded: G and rover/msg/G."""

from __future__ import annotations

from generated.messages import G
from generated.pb2 import all_pb2
from roverlink.runtime.core.handler import Handler, Route


class ForwardedHandler(Handler[all_pb2.G, G]):
    """G as rover/msg/G.

    Number 7 of the envelope, arm_to_ros, topic forwarded.
    """

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
        """Convert G to rover/msg/G."""
        return G(
            x=payload.x,
        )

    @staticmethod
    def from_ros(message: G) -> all_pb2.G:
        """Convert rover/msg/G to G."""
        return all_pb2.G(
            x=message.x,
        )
