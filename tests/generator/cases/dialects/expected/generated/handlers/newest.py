# Generated from mapping.yaml (row newest) and newest.proto; do not edit.
# Regenerate with: roverlink generate
"""newest (3): Newest to rover/msg/Newest on newest."""

from __future__ import annotations

from generated.messages import Newest
from generated.pb2 import newest_pb2
from roverlink.runtime.convert import oneof
from roverlink.runtime.core.handler import Handler, Route

_WHICH_WHICH = {"a": Newest.WHICH_A, "b": Newest.WHICH_B}


class NewestHandler(Handler[newest_pb2.Newest, Newest]):
    """Newest to the topic newest."""

    route = Route(number=3, name="newest", topic="newest", direction="board_to_ros")
    payload_type = newest_pb2.Newest
    message_type = Newest

    @staticmethod
    def to_ros(payload: newest_pb2.Newest) -> Newest:
        """The message that says what the payload says."""
        return Newest(
            has_x=payload.HasField("x"),
            x=payload.x,
            names=list(payload.names),
            which_which=oneof.number(payload, "which", _WHICH_WHICH),
            a=payload.a,
            b=payload.b,
            has_gear=payload.HasField("gear"),
            gear=payload.gear,
            gears=bytes(payload.gears),
        )

    @staticmethod
    def from_ros(message: Newest) -> newest_pb2.Newest:
        """The payload that says what the message says."""
        which_which = oneof.member(message.which_which, _WHICH_WHICH, "which_which")
        return newest_pb2.Newest(
            x=message.x if message.has_x else None,
            names=message.names,
            a=message.a if which_which == "a" else None,
            b=message.b if which_which == "b" else None,
            gear=message.gear if message.has_gear else None,
            gears=message.gears,
        )
