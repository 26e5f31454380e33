# Generated from mapping.yaml (row holder) and empty.proto; do not edit.
# Regenerate with: roverlink generate
"""holder (3): Holder from rover/msg/Holder on holder."""

from __future__ import annotations

from generated.conversions import nothing
from generated.handlers.ping import PingHandler
from generated.messages import Holder
from generated.pb2 import empty_pb2
from roverlink.runtime.core.handler import Handler, Route


class HolderHandler(Handler[empty_pb2.Holder, Holder]):
    """Holder from the topic holder."""

    route = Route(number=3, name="holder", topic="holder", direction="ros_to_board")
    payload_type = empty_pb2.Holder
    message_type = Holder

    @staticmethod
    def to_ros(payload: empty_pb2.Holder) -> Holder:
        """The message that says what the payload says."""
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
        """The payload that says what the message says."""
        return empty_pb2.Holder(
            nothing=nothing.from_ros(message.nothing),
            ping=PingHandler.from_ros(message.ping),
            after=message.after,
            many=[nothing.from_ros(item) for item in message.many],
            maybe=nothing.from_ros(message.maybe) if message.has_maybe else None,
        )
