# Generated from mapping.yaml (row target) and fix.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row target: Target and rover/msg/Target."""

from __future__ import annotations

from generated.conversions import position
from generated.messages import Target
from generated.pb2 import fix_pb2
from roverlink.runtime.core.handler import Handler, Route


class TargetHandler(Handler[fix_pb2.Target, Target]):
    """Target as rover/msg/Target.

    Number 2 of the envelope, ros_to_board, topic target.
    """

    route = Route(
        number=2,
        name="target",
        topic="target",
        direction="ros_to_board",
    )
    payload_type = fix_pb2.Target
    message_type = Target

    @staticmethod
    def to_ros(payload: fix_pb2.Target) -> Target:
        """Convert Target to rover/msg/Target."""
        return Target(
            has_name=payload.HasField("name"),
            name=payload.name,
            has_token=payload.HasField("token"),
            token=payload.token,
            has_exact=payload.HasField("exact"),
            exact=payload.exact,
            has_due=payload.HasField("due"),
            due=payload.due,
            path=[position.to_ros(item) for item in payload.path],
        )

    @staticmethod
    def from_ros(message: Target) -> fix_pb2.Target:
        """Convert rover/msg/Target to Target."""
        return fix_pb2.Target(
            name=message.name if message.has_name else None,
            token=message.token if message.has_token else None,
            exact=message.exact if message.has_exact else None,
            due=message.due if message.has_due else None,
            path=[position.from_ros(item) for item in message.path],
        )
