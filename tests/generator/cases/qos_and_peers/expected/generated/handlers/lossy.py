# Generated from mapping.yaml (row lossy) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row lossy: C and rover/msg/C."""

from __future__ import annotations

from generated.messages import C
from generated.pb2 import all_pb2
from roverlink.runtime.core.handler import Handler, Qos, Route


class LossyHandler(Handler[all_pb2.C, C]):
    """C as rover/msg/C.

    Number 3 of the envelope, arm_to_ros, topic lossy.
    """

    route = Route(
        number=3,
        name="lossy",
        topic="lossy",
        direction="arm_to_ros",
        qos=Qos(
            reliability="best_effort",
            depth=1,
        ),
    )
    payload_type = all_pb2.C
    message_type = C

    @staticmethod
    def to_ros(payload: all_pb2.C) -> C:
        """Convert C to rover/msg/C."""
        return C(
            x=payload.x,
        )

    @staticmethod
    def from_ros(message: C) -> all_pb2.C:
        """Convert rover/msg/C to C."""
        return all_pb2.C(
            x=message.x,
        )
