# Generated from mapping.yaml (row apart) and command.proto; do not edit.
# Regenerate with: roverlink generate
"""apart (3): Apart to rover/msg/Apart on apart."""

from __future__ import annotations

from generated.messages import Apart
from generated.pb2 import command_pb2
from roverlink.runtime.convert import oneof
from roverlink.runtime.core.handler import Handler, Route

_WHICH_LEFT = {"number": Apart.RESULT_NUMBER, "text": Apart.RESULT_TEXT}
_WHICH_RESULT = {"number": Apart.RESULT_NUMBER}


class ApartHandler(Handler[command_pb2.Apart, Apart]):
    """Apart to the topic apart."""

    route = Route(number=3, name="apart", topic="apart", direction="board_to_ros")
    payload_type = command_pb2.Apart
    message_type = Apart

    @staticmethod
    def to_ros(payload: command_pb2.Apart) -> Apart:
        """The message that says what the payload says."""
        return Apart(
            which_left=oneof.number(payload.left, "result", _WHICH_LEFT),
            left_number=payload.left.number,
            left_text=payload.left.text,
            which_result=oneof.number(payload.right, "result", _WHICH_RESULT),
            right_number=payload.right.number,
        )

    @staticmethod
    def from_ros(message: Apart) -> command_pb2.Apart:
        """The payload that says what the message says."""
        which_left = oneof.member(message.which_left, _WHICH_LEFT, "which_left")
        which_result = oneof.member(message.which_result, _WHICH_RESULT, "which_result")
        return command_pb2.Apart(
            left={
                "number": message.left_number if which_left == "number" else None,
                "text": message.left_text if which_left == "text" else None,
            },
            right={
                "number": message.right_number if which_result == "number" else None,
            },
        )
