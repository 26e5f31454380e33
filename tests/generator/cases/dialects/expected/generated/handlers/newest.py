# Generated from mapping.yaml (row newest) and newest.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row newest: Newest and rover/msg/Newest."""

from __future__ import annotations

from generated.messages import Newest
from generated.pb2 import newest_pb2
from roverlink.runtime.convert import oneof
from roverlink.runtime.core.handler import Handler, Route

WHICH_WHICH_MEMBERS = {
    "a": Newest.WHICH_A,
    "b": Newest.WHICH_B,
}


class NewestHandler(Handler[newest_pb2.Newest, Newest]):
    """Newest as rover/msg/Newest.

    Number 3 of the envelope, board_to_ros, topic newest.
    """

    route = Route(
        number=3,
        name="newest",
        topic="newest",
        direction="board_to_ros",
    )
    payload_type = newest_pb2.Newest
    message_type = Newest

    @staticmethod
    def to_ros(payload: newest_pb2.Newest) -> Newest:
        """Convert Newest to rover/msg/Newest."""
        return Newest(
            has_x=payload.HasField("x"),
            x=payload.x,
            names=list(payload.names),
            which_which=oneof.number(payload, "which", WHICH_WHICH_MEMBERS),
            a=payload.a,
            b=payload.b,
            has_gear=payload.HasField("gear"),
            gear=payload.gear,
            gears=bytes(payload.gears),
        )

    @staticmethod
    def from_ros(message: Newest) -> newest_pb2.Newest:
        """Convert rover/msg/Newest to Newest."""
        which_which = oneof.member(
            message.which_which, WHICH_WHICH_MEMBERS, "which_which"
        )
        return newest_pb2.Newest(
            x=message.x if message.has_x else None,
            names=message.names,
            a=message.a if which_which == "a" else None,
            b=message.b if which_which == "b" else None,
            gear=message.gear if message.has_gear else None,
            gears=message.gears,
        )
