# Generated from mapping.yaml (row fixed) and any.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row fixed: Fixed and rover/msg/Fixed."""

from __future__ import annotations

from generated.conversions import duration_, oneof_, timestamp_
from generated.messages import Fixed
from generated.pb2 import any_pb2
from roverlink.runtime.convert import oneof
from roverlink.runtime.convert.well_known import timestamp
from roverlink.runtime.core.handler import Handler, Route

WHICH_CDR_MEMBERS = {
    "a": Fixed.CDR_A,
}


class FixedHandler(Handler[any_pb2.Fixed, Fixed]):
    """Fixed as rover/msg/Fixed.

    Number 3 of the envelope, board_to_ros, topic fixed.
    """

    route = Route(
        number=3,
        name="fixed",
        topic="fixed",
        direction="board_to_ros",
    )
    payload_type = any_pb2.Fixed
    message_type = Fixed

    @staticmethod
    def to_ros(payload: any_pb2.Fixed) -> Fixed:
        """Convert Fixed to rover/msg/Fixed."""
        return Fixed(
            timestamp=timestamp_.to_ros(payload.timestamp),
            duration=duration_.to_ros(payload.duration),
            oneof=oneof_.to_ros(payload.oneof),
            which_cdr=oneof.number(payload, "cdr", WHICH_CDR_MEMBERS),
            a=payload.a,
            stamp=timestamp.to_ros(payload.stamp, "stamp"),
        )

    @staticmethod
    def from_ros(message: Fixed) -> any_pb2.Fixed:
        """Convert rover/msg/Fixed to Fixed."""
        which_cdr = oneof.member(message.which_cdr, WHICH_CDR_MEMBERS, "which_cdr")
        return any_pb2.Fixed(
            timestamp=timestamp_.from_ros(message.timestamp),
            duration=duration_.from_ros(message.duration),
            oneof=oneof_.from_ros(message.oneof),
            a=message.a if which_cdr == "a" else None,
            stamp=timestamp.from_ros(message.stamp, "stamp"),
        )
