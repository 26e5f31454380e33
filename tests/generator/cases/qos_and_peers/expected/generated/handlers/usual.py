# Generated from mapping.yaml (row usual) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row usual: F and rover/msg/F."""

from __future__ import annotations

from generated.messages import F
from generated.pb2 import all_pb2
from roverlink.runtime.core.handler import Handler, Route


class UsualHandler(Handler[all_pb2.F, F]):
    """F as rover/msg/F.

    Number 6 of the envelope, base_to_ros, topic usual.
    """

    route = Route(
        number=6,
        name="usual",
        topic="usual",
        direction="base_to_ros",
    )
    payload_type = all_pb2.F
    message_type = F

    @staticmethod
    def to_ros(payload: all_pb2.F) -> F:
        """Convert F to rover/msg/F."""
        return F(
            x=payload.x,
        )

    @staticmethod
    def from_ros(message: F) -> all_pb2.F:
        """Convert rover/msg/F to F."""
        return all_pb2.F(
            x=message.x,
        )
