# Generated from mapping.yaml (row queued) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row queued: B and rover/msg/B."""

from __future__ import annotations

from generated.messages import B
from generated.pb2 import all_pb2
from roverlink.runtime.core.handler import Handler, Qos, Route


class QueuedHandler(Handler[all_pb2.B, B]):
    """B as rover/msg/B.

    Number 2 of the envelope, arm_to_ros, topic queued.
    """

    route = Route(
        number=2,
        name="queued",
        topic="queued",
        direction="arm_to_ros",
        qos=Qos(
            depth=50,
        ),
    )
    payload_type = all_pb2.B
    message_type = B

    @staticmethod
    def to_ros(payload: all_pb2.B) -> B:
        """Convert B to rover/msg/B."""
        return B(
            x=payload.x,
        )

    @staticmethod
    def from_ros(message: B) -> all_pb2.B:
        """Convert rover/msg/B to B."""
        return all_pb2.B(
            x=message.x,
        )
