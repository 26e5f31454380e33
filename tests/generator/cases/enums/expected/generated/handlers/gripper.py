# Generated from mapping.yaml (row gripper) and gripper.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row gripper: Gripper and rover/msg/Gripper."""

from __future__ import annotations

from generated.conversions import health
from generated.messages import Gripper, GripperMode
from generated.pb2 import gripper_pb2
from roverlink.runtime.core.handler import Handler, Route


class GripperHandler(Handler[gripper_pb2.Gripper, Gripper]):
    """Gripper as rover/msg/Gripper.

    Number 1 of the envelope, board_to_ros, topic gripper.
    """

    route = Route(
        number=1,
        name="gripper",
        topic="gripper",
        direction="board_to_ros",
    )
    payload_type = gripper_pb2.Gripper
    message_type = Gripper

    @staticmethod
    def to_ros(payload: gripper_pb2.Gripper) -> Gripper:
        """Convert Gripper to rover/msg/Gripper."""
        return Gripper(
            mode=GripperMode(mode=payload.mode),
            history=[GripperMode(mode=item) for item in payload.history],
            small=payload.small,
            medium=payload.medium,
            large=payload.large,
            signed_field=payload.signed,
            signed_medium=payload.signed_medium,
            signed_large=payload.signed_large,
            aliased=payload.aliased,
            health=health.to_ros(payload.health),
        )

    @staticmethod
    def from_ros(message: Gripper) -> gripper_pb2.Gripper:
        """Convert rover/msg/Gripper to Gripper."""
        return gripper_pb2.Gripper(
            mode=message.mode.mode,
            history=[item.mode for item in message.history],
            small=message.small,
            medium=message.medium,
            large=message.large,
            signed=message.signed_field,
            signed_medium=message.signed_medium,
            signed_large=message.signed_large,
            aliased=message.aliased,
            health=health.from_ros(message.health),
        )
