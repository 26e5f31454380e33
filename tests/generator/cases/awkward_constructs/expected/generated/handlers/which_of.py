# Generated from mapping.yaml (row which_of) and any.proto; do not edit.
# Regenerate with: roverlink generate
"""which_of (2): WhichOf from rover/msg/WhichOf on which_of."""

from __future__ import annotations

from google.protobuf import wrappers_pb2

from generated.conversions import which_message
from generated.messages import WhichOf
from generated.pb2 import any_pb2
from roverlink.runtime.convert import oneof
from roverlink.runtime.core.handler import Handler, Route

_WHICH_MESSAGE = {"which": WhichOf.MESSAGE_WHICH, "text": WhichOf.MESSAGE_TEXT}


class WhichOfHandler(Handler[any_pb2.WhichOf, WhichOf]):
    """WhichOf from the topic which_of."""

    route = Route(number=2, name="which_of", topic="which_of", direction="ros_to_board")
    payload_type = any_pb2.WhichOf
    message_type = WhichOf

    @staticmethod
    def to_ros(payload: any_pb2.WhichOf) -> WhichOf:
        """The message that says what the payload says."""
        return WhichOf(
            which_message=oneof.number(payload, "message", _WHICH_MESSAGE),
            which=which_message.to_ros(payload.which),
            text=payload.text.value,
        )

    @staticmethod
    def from_ros(message: WhichOf) -> any_pb2.WhichOf:
        """The payload that says what the message says."""
        which_message_ = oneof.member(
            message.which_message,
            _WHICH_MESSAGE,
            "which_message",
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
