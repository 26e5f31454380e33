# Generated from mapping.yaml (row fixed) and command.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row fixed: Fixed and rover/msg/Fixed."""

from __future__ import annotations

from generated.messages import Fixed
from generated.pb2 import command_pb2
from roverlink.runtime.convert import oneof
from roverlink.runtime.convert.well_known import timestamp
from roverlink.runtime.core.handler import Handler, Route

WHICH_CHOICE_MEMBERS = {
    "a": Fixed.CHOICE_A,
    "b": Fixed.CHOICE_B,
}


class FixedHandler(Handler[command_pb2.Fixed, Fixed]):
    """Fixed as rover/msg/Fixed.

    Number 4 of the envelope, board_to_ros, topic fixed.
    """

    route = Route(
        number=4,
        name="fixed",
        topic="fixed",
        direction="board_to_ros",
    )
    payload_type = command_pb2.Fixed
    message_type = Fixed

    @staticmethod
    def to_ros(payload: command_pb2.Fixed) -> Fixed:
        """Convert Fixed to rover/msg/Fixed."""
        return Fixed(
            which_choice=oneof.number(payload, "choice", WHICH_CHOICE_MEMBERS),
            a=payload.a,
            b=payload.b,
            stamp=timestamp.to_ros(payload.stamp, "stamp"),
            has_maybe=payload.HasField("maybe"),
            maybe=timestamp.to_ros(payload.maybe, "maybe"),
        )

    @staticmethod
    def from_ros(message: Fixed) -> command_pb2.Fixed:
        """Convert rover/msg/Fixed to Fixed."""
        which_choice = oneof.member(
            message.which_choice, WHICH_CHOICE_MEMBERS, "which_choice"
        )
        return command_pb2.Fixed(
            a=message.a if which_choice == "a" else None,
            b=message.b if which_choice == "b" else None,
            stamp=timestamp.from_ros(message.stamp, "stamp"),
            maybe=(
                timestamp.from_ros(message.maybe, "maybe")
                if message.has_maybe
                else None
            ),
        )
