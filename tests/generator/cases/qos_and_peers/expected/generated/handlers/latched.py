# Generated from mapping.yaml (row latched) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row latched: D and rover/msg/D."""

from __future__ import annotations

from generated.messages import D
from generated.pb2 import all_pb2
from roverlink.runtime.core.handler import Handler, Qos, Route


class LatchedHandler(Handler[all_pb2.D, D]):
    """D as rover/msg/D.

    Number 4 of the envelope, ros_to_base, topic /latched.
    """

    route = Route(
        number=4,
        name="latched",
        topic="/latched",
        direction="ros_to_base",
        qos=Qos(
            durability="transient_local",
        ),
    )
    payload_type = all_pb2.D
    message_type = D

    @staticmethod
    def to_ros(payload: all_pb2.D) -> D:
        """Convert D to rover/msg/D."""
        return D(
            x=payload.x,
        )

    @staticmethod
    def from_ros(message: D) -> all_pb2.D:
        """Convert rover/msg/D to D."""
        return all_pb2.D(
            x=message.x,
        )
