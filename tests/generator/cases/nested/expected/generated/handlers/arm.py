# Generated from mapping.yaml (row arm) and arm.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row arm: Arm and rover/msg/Arm."""

from __future__ import annotations

from generated.conversions import arm_segment, joint
from generated.handlers.wrist import WristHandler
from generated.messages import Arm
from generated.pb2 import arm_pb2
from roverlink.runtime.core.handler import Handler, Route


class ArmHandler(Handler[arm_pb2.Arm, Arm]):
    """Arm as rover/msg/Arm.

    Number 1 of the envelope, board_to_ros, topic arm.
    """

    route = Route(
        number=1,
        name="arm",
        topic="arm",
        direction="board_to_ros",
    )
    payload_type = arm_pb2.Arm
    message_type = Arm

    @staticmethod
    def to_ros(payload: arm_pb2.Arm) -> Arm:
        """Convert Arm to rover/msg/Arm."""
        return Arm(
            upper=arm_segment.to_ros(payload.upper),
            others=[arm_segment.to_ros(item) for item in payload.others],
            elbow=joint.to_ros(payload.elbow),
            wrist=WristHandler.to_ros(payload.wrist),
        )

    @staticmethod
    def from_ros(message: Arm) -> arm_pb2.Arm:
        """Convert rover/msg/Arm to Arm."""
        return arm_pb2.Arm(
            upper=arm_segment.from_ros(message.upper),
            others=[arm_segment.from_ros(item) for item in message.others],
            elbow=joint.from_ros(message.elbow),
            wrist=WristHandler.from_ros(message.wrist),
        )
