# Generated from mapping.yaml (row spread) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row spread: H and rover/msg/H."""

from __future__ import annotations

from generated.messages import H
from generated.pb2 import all_pb2
from roverlink.runtime.core.handler import Handler, Route


class SpreadHandler(Handler[all_pb2.H, H]):
    """H as rover/msg/H.

    Number 8 of the envelope, arm_to_ros, topic spread.
    """

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
        """Convert H to rover/msg/H."""
        return H(
            x=payload.x,
        )

    @staticmethod
    def from_ros(message: H) -> all_pb2.H:
        """Convert rover/msg/H to H."""
        return all_pb2.H(
            x=message.x,
        )
