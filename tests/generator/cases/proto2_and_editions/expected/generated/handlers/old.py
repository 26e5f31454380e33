# Generated from mapping.yaml (row old) and old.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row old: Old and rover/msg/Old."""

from __future__ import annotations

from generated.messages import Old
from generated.pb2 import old_pb2
from roverlink.runtime.core.handler import Handler, Route


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
            id=payload.id,
            has_value=payload.HasField("value"),
            value=payload.value,
            values=list(payload.values),
            has_level=payload.HasField("level"),
            level=payload.level,
            needed=payload.needed,
        )

    @staticmethod
    def from_ros(message: Old) -> old_pb2.Old:
        """Convert rover/msg/Old to Old."""
        return old_pb2.Old(
            id=message.id,
            value=message.value if message.has_value else None,
            values=message.values,
            level=message.level if message.has_level else None,
            needed=message.needed,
        )
