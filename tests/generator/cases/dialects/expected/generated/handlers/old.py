# Generated from mapping.yaml (row old) and old.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row old: Old and rover/msg/Old."""

from __future__ import annotations

from generated.conversions import old_more, old_part, old_result
from generated.messages import Old, OldByNumberEntry
from generated.pb2 import old_pb2
from roverlink.runtime.convert import oneof
from roverlink.runtime.convert.maps import mapping
from roverlink.runtime.convert.well_known import timestamp
from roverlink.runtime.core.handler import Handler, Route

WHICH_ONE_MEMBERS = {
    "text": Old.ONE_TEXT,
    "part": Old.ONE_PART,
}


class OldHandler(Handler[old_pb2.Old, Old]):
    """Old as rover/msg/Old.

    Number 1 of the envelope, board_to_ros, topic old.
    """

    route = Route(
        number=1,
        name="old",
        topic="old",
        direction="board_to_ros",
    )
    payload_type = old_pb2.Old
    message_type = Old

    @staticmethod
    def to_ros(payload: old_pb2.Old) -> Old:
        """Convert Old to rover/msg/Old."""
        return Old(
            needed=payload.needed,
            has_level=payload.HasField("level"),
            level=payload.level,
            levels=list(payload.levels),
            result=old_result.to_ros(payload.result),
            more=[old_more.to_ros(item) for item in payload.more],
            by_number=[
                OldByNumberEntry(key=key, value=value)
                for key, value in sorted(payload.by_number.items())
            ],
            which_one=oneof.number(payload, "one", WHICH_ONE_MEMBERS),
            text=payload.text,
            part=old_part.to_ros(payload.part),
            stamp=timestamp.to_ros(payload.stamp, "stamp"),
            has_data=payload.HasField("data"),
            data=payload.data,
        )

    @staticmethod
    def from_ros(message: Old) -> old_pb2.Old:
        """Convert rover/msg/Old to Old."""
        which_one = oneof.member(message.which_one, WHICH_ONE_MEMBERS, "which_one")
        return old_pb2.Old(
            needed=message.needed,
            level=message.level if message.has_level else None,
            levels=message.levels,
            result=old_result.from_ros(message.result),
            more=[old_more.from_ros(item) for item in message.more],
            by_number=mapping(
                ((item.key, item.value) for item in message.by_number), "by_number"
            ),
            text=message.text if which_one == "text" else None,
            part=old_part.from_ros(message.part) if which_one == "part" else None,
            stamp=timestamp.from_ros(message.stamp, "stamp"),
            data=message.data if message.has_data else None,
        )
