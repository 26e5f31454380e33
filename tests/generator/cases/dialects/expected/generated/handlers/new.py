# Generated from mapping.yaml (row new) and new.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row new: New and rover/msg/New."""

from __future__ import annotations

from generated.conversions import part
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
            part=part.to_ros(payload.part),
            parts=[part.to_ros(item) for item in payload.parts],
            expanded=list(payload.expanded),
            has_closed=payload.HasField("closed"),
            closed=payload.closed,
            needed=payload.needed,
        )

    @staticmethod
    def from_ros(message: New) -> new_pb2.New:
        """Convert rover/msg/New to New."""
        return new_pb2.New(
            explicit=message.explicit_field if message.has_explicit_field else None,
            implicit=message.implicit,
            part=part.from_ros(message.part),
            parts=[part.from_ros(item) for item in message.parts],
            expanded=message.expanded,
            closed=message.closed if message.has_closed else None,
            needed=message.needed,
        )
