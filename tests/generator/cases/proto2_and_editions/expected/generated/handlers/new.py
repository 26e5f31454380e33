# Generated from mapping.yaml (row new) and new.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row new: New and rover/msg/New."""

from __future__ import annotations

from generated.conversions import new2
from generated.messages import New
from generated.pb2 import new_pb2
from roverlink.runtime.core.handler import Handler, Route


class NewHandler(Handler[new_pb2.New, New]):
    """New as rover/msg/New.

    Number 2 of the envelope, board_to_ros, topic new.
    """

    route = Route(
        number=2,
        name="new",
        topic="new",
        direction="board_to_ros",
    )
    payload_type = new_pb2.New
    message_type = New

    @staticmethod
    def to_ros(payload: new_pb2.New) -> New:
        """Convert New to rover/msg/New."""
        return New(
            has_explicit_field=payload.HasField("explicit"),
            explicit_field=payload.explicit,
            implicit=payload.implicit,
            nested=new2.to_ros(payload.nested),
        )

    @staticmethod
    def from_ros(message: New) -> new_pb2.New:
        """Convert rover/msg/New to New."""
        return new_pb2.New(
            explicit=message.explicit_field if message.has_explicit_field else None,
            implicit=message.implicit,
            nested=new2.from_ros(message.nested),
        )
