# Generated from mapping.yaml (row joints) and gripper.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row joints: Joints and rover/msg/Joints."""

from __future__ import annotations

from generated.messages import HealthCode, Joints
from generated.pb2 import gripper_pb2
from roverlink.runtime.core.handler import Handler, Route


class JointsHandler(Handler[gripper_pb2.Joints, Joints]):
    """Joints as rover/msg/Joints.

    Number 2 of the envelope, board_to_ros, topic joints.
    """

    route = Route(
        number=2,
        name="joints",
        topic="joints",
        direction="board_to_ros",
    )
    payload_type = gripper_pb2.Joints
    message_type = Joints

    @staticmethod
    def to_ros(payload: gripper_pb2.Joints) -> Joints:
        """Convert Joints to rover/msg/Joints."""
        return Joints(
            small=bytes(payload.small),
            medium=list(payload.medium),
            signed_field=list(payload.signed),
            codes=[HealthCode(code=item) for item in payload.codes],
        )

    @staticmethod
    def from_ros(message: Joints) -> gripper_pb2.Joints:
        """Convert rover/msg/Joints to Joints."""
        return gripper_pb2.Joints(
            small=message.small,
            medium=message.medium,
            signed=message.signed_field,
            codes=[item.code for item in message.codes],
        )
