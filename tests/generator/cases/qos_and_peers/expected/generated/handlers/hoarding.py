# Generated from mapping.yaml (row hoarding) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row hoarding: E and rover/msg/E."""

from __future__ import annotations

from generated.messages import E
from generated.pb2 import all_pb2
from roverlink.runtime.core.handler import Handler, Qos, Route


class HoardingHandler(Handler[all_pb2.E, E]):
    """E as rover/msg/E.

    Number 5 of the envelope, base_to_ros, topic ~/hoarding.
    """

    route = Route(
        number=5,
        name="hoarding",
        topic="~/hoarding",
        direction="base_to_ros",
        qos=Qos(
            history="keep_all",
        ),
    )
    payload_type = all_pb2.E
    message_type = E

    @staticmethod
    def to_ros(payload: all_pb2.E) -> E:
        """Convert E to rover/msg/E."""
        return E(
            x=payload.x,
        )

    @staticmethod
    def from_ros(message: E) -> all_pb2.E:
        """Convert rover/msg/E to E."""
        return all_pb2.E(
            x=message.x,
        )
