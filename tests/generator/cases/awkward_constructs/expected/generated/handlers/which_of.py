# Generated from mapping.yaml (row which_of) and any.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row which_of: WhichOf and rover/msg/WhichOf."""

from __future__ import annotations

from google.protobuf import wrappers_pb2

from generated.conversions import which_message
from generated.messages import WhichOf
from generated.pb2 import any_pb2
from roverlink.runtime.convert import oneof
from roverlink.runtime.core.handler import Handler, Route

WHICH_MESSAGE_MEMBERS = {
    "which": WhichOf.MESSAGE_WHICH,
    "text": WhichOf.MESSAGE_TEXT,
}


class WhichOfHandler(Handler[any_pb2.WhichOf, WhichOf]):
    """WhichOf as rover/msg/WhichOf.

    Number 2 of the envelope, ros_to_board, topic which_of.
    """

    route = Route(
        number=2,
        name="which_of",
        topic="which_of",
        direction="ros_to_board",
    )
    payload_type = any_pb2.WhichOf
    message_type = WhichOf

    @staticmethod
    def to_ros(payload: any_pb2.WhichOf) -> WhichOf:
        """Convert WhichOf to rover/msg/WhichOf."""
        return WhichOf(
            which_message=oneof.number(payload, "message", WHICH_MESSAGE_MEMBERS),
            which=which_message.to_ros(payload.which),
            text=payload.text.value,
        )

    @staticmethod
    def from_ros(message: WhichOf) -> any_pb2.WhichOf:
        """Convert rover/msg/WhichOf to WhichOf."""
        which_message_ = oneof.member(
            message.which_message, WHICH_MESSAGE_MEMBERS, "which_message"
        )
        return any_pb2.WhichOf(
            which=(
                which_message.from_ros(message.which)
                if which_message_ == "which"
                else None
            ),
            text=(
                wrappers_pb2.StringValue(value=message.text)
                if which_message_ == "text"
                else None
            ),
        )
