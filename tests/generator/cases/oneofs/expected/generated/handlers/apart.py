# Generated from mapping.yaml (row apart) and command.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row apart: Apart and rover/msg/Apart."""

from __future__ import annotations

from generated.messages import Apart
from generated.pb2 import command_pb2
from roverlink.runtime.convert import oneof
from roverlink.runtime.core.handler import Handler, Route

WHICH_LEFT_MEMBERS = {
    "number": Apart.RESULT_NUMBER,
    "text": Apart.RESULT_TEXT,
}
WHICH_RESULT_MEMBERS = {
    "number": Apart.RESULT_NUMBER,
}


class ApartHandler(Handler[command_pb2.Apart, Apart]):
    """Apart as rover/msg/Apart.

    Number 3 of the envelope, board_to_ros, topic apart.
    """

    route = Route(
        number=3,
        name="apart",
        topic="apart",
        direction="board_to_ros",
    )
    payload_type = command_pb2.Apart
    message_type = Apart

    @staticmethod
    def to_ros(payload: command_pb2.Apart) -> Apart:
        """Convert Apart to rover/msg/Apart."""
        return Apart(
            which_left=oneof.number(payload.left, "result", WHICH_LEFT_MEMBERS),
            left_number=payload.left.number,
            left_text=payload.left.text,
            which_result=oneof.number(payload.right, "result", WHICH_RESULT_MEMBERS),
            right_number=payload.right.number,
        )

    @staticmethod
    def from_ros(message: Apart) -> command_pb2.Apart:
        """Convert rover/msg/Apart to Apart."""
        which_left = oneof.member(message.which_left, WHICH_LEFT_MEMBERS, "which_left")
        which_result = oneof.member(
            message.which_result, WHICH_RESULT_MEMBERS, "which_result"
        )
        return command_pb2.Apart(
            left={
                "number": message.left_number if which_left == "number" else None,
                "text": message.left_text if which_left == "text" else None,
            },
            right={
                "number": message.right_number if which_result == "number" else None
            },
        )
