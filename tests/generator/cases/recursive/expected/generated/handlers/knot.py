# Generated from mapping.yaml (row knot) and box.proto; do not edit.
# Regenerate with: roverlink generate
"""knot (7): Knot to rover/msg/Knot on knot."""

from __future__ import annotations

from generated.conversions import knot_level2, loop
from generated.messages import Knot
from generated.pb2 import box_pb2
from runtime.handler import Handler, Route


class KnotHandler(Handler[box_pb2.Knot, Knot]):
    """Knot to the topic knot."""

    route = Route(number=7, name="knot", topic="knot", direction="board_to_ros")
    payload_type = box_pb2.Knot
    message_type = Knot

    @staticmethod
    def to_ros(payload: box_pb2.Knot) -> Knot:
        """The message that says what the payload says."""
        return Knot(
            there=payload.here,
            has_self=payload.HasField("self"),
            self=knot_level2.to_ros(payload.self),
            has_loop=payload.HasField("loop"),
            loop=loop.to_ros(payload.loop),
        )

    @staticmethod
    def from_ros(message: Knot) -> box_pb2.Knot:
        """The payload that says what the message says."""
        return box_pb2.Knot(
            here=message.there,
            self=knot_level2.from_ros(message.self) if message.has_self else None,
            loop=loop.from_ros(message.loop) if message.has_loop else None,
        )
