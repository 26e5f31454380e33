# Generated from mapping.yaml (row holder) and empty.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row holder: Holder and rover/msg/Holder."""

from __future__ import annotations

from generated.conversions import nothing
from generated.handlers.ping import PingHandler
from generated.messages import Holder
from generated.pb2 import empty_pb2
from roverlink.runtime.core.handler import Handler, Route


class HolderHandler(Handler[empty_pb2.Holder, Holder]):
    """Holder as rover/msg/Holder.

    Number 3 of the envelope, ros_to_board, topic holder.
    """

    route = Route(
        number=3,
        name="holder",
        topic="holder",
        direction="ros_to_board",
    )
    payload_type = empty_pb2.Holder
    message_type = Holder

    @staticmethod
    def to_ros(payload: empty_pb2.Holder) -> Holder:
        """Convert Holder to rover/msg/Holder."""
        return Holder(
            nothing=nothing.to_ros(payload.nothing),
            ping=PingHandler.to_ros(payload.ping),
            after=payload.after,
            many=[nothing.to_ros(item) for item in payload.many],
            has_maybe=payload.HasField("maybe"),
            maybe=nothing.to_ros(payload.maybe),
        )

    @staticmethod
    def from_ros(message: Holder) -> empty_pb2.Holder:
        """Convert rover/msg/Holder to Holder."""
        return empty_pb2.Holder(
            nothing=nothing.from_ros(message.nothing),
            ping=PingHandler.from_ros(message.ping),
            after=message.after,
            many=[nothing.from_ros(item) for item in message.many],
            maybe=nothing.from_ros(message.maybe) if message.has_maybe else None,
        )
