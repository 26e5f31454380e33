# Generated from mapping.yaml (row lists) and scalars.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row lists: Lists and rover/msg/Lists."""

from __future__ import annotations

from generated.messages import Lists
from generated.pb2 import scalars_pb2
from roverlink.runtime.core.handler import Handler, Route


class ListsHandler(Handler[scalars_pb2.Lists, Lists]):
    """Lists as rover/msg/Lists.

    Number 2 of the envelope, ros_to_board, topic lists.
    """

    route = Route(
        number=2,
        name="lists",
        topic="lists",
        direction="ros_to_board",
    )
    payload_type = scalars_pb2.Lists
    message_type = Lists

    @staticmethod
    def to_ros(payload: scalars_pb2.Lists) -> Lists:
        """Convert Lists to rover/msg/Lists."""
        return Lists(
            doubles=list(payload.doubles),
            floats=list(payload.floats),
            int32s=list(payload.int32s),
            int64s=list(payload.int64s),
            uint32s=list(payload.uint32s),
            uint64s=list(payload.uint64s),
            sint32s=list(payload.sint32s),
            sint64s=list(payload.sint64s),
            fixed32s=list(payload.fixed32s),
            fixed64s=list(payload.fixed64s),
            sfixed32s=list(payload.sfixed32s),
            sfixed64s=list(payload.sfixed64s),
            bools=list(payload.bools),
            strings=list(payload.strings),
            unpacked=list(payload.unpacked),
        )

    @staticmethod
    def from_ros(message: Lists) -> scalars_pb2.Lists:
        """Convert rover/msg/Lists to Lists."""
        return scalars_pb2.Lists(
            doubles=message.doubles,
            floats=message.floats,
            int32s=message.int32s,
            int64s=message.int64s,
            uint32s=message.uint32s,
            uint64s=message.uint64s,
            sint32s=message.sint32s,
            sint64s=message.sint64s,
            fixed32s=message.fixed32s,
            fixed64s=message.fixed64s,
            sfixed32s=message.sfixed32s,
            sfixed64s=message.sfixed64s,
            bools=message.bools,
            strings=message.strings,
            unpacked=message.unpacked,
        )
