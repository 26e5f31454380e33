# Generated from mapping.yaml (row plain) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row plain: A and rover/msg/A."""

from __future__ import annotations

from generated.messages import A
from generated.pb2 import all_pb2
from roverlink.runtime.core.handler import Handler, Route


class PlainHandler(Handler[all_pb2.A, A]):
    """A as rover/msg/A.

    Number 1 of the envelope, arm_to_ros, topic plain.
    """

    route = Route(
        number=1,
        name="plain",
        topic="plain",
        direction="arm_to_ros",
    )
    payload_type = all_pb2.A
    message_type = A

    @staticmethod
    def to_ros(payload: all_pb2.A) -> A:
        """Convert A to rover/msg/A."""
        return A(
            x=payload.x,
        )

    @staticmethod
    def from_ros(message: A) -> all_pb2.A:
        """Convert rover/msg/A to A."""
        return all_pb2.A(
            x=message.x,
        )
