# Generated from mapping.yaml (row joints) and gripper.proto; do not edit.
# Regenerate with: roverlink generate
"""joints (2): Joints to rover/msg/Joints on joints."""

from __future__ import annotations

from generated.messages import HealthCode, Joints
from generated.pb2 import gripper_pb2
from roverlink.runtime.core.handler import Handler, Route


class JointsHandler(Handler[gripper_pb2.Joints, Joints]):
    """Joints to the topic joints."""

    route = Route(number=2, name="joints", topic="joints", direction="board_to_ros")
    payload_type = gripper_pb2.Joints
    message_type = Joints

    @staticmethod
    def to_ros(payload: gripper_pb2.Joints) -> Joints:
        """The message that says what the payload says."""
        return Joints(
            small=bytes(payload.small),
            medium=list(payload.medium),
            signed_field=list(payload.signed),
            codes=[HealthCode(code=item) for item in payload.codes],
        )

    @staticmethod
    def from_ros(message: Joints) -> gripper_pb2.Joints:
        """The payload that says what the message says."""
        return gripper_pb2.Joints(
            small=message.small,
            medium=message.medium,
            signed=message.signed_field,
            codes=[item.code for item in message.codes],
        )
