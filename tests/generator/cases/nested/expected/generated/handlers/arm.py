# Generated from mapping.yaml (row arm) and arm.proto; do not edit.
# Regenerate with: roverlink generate
"""arm (1): Arm to rover/msg/Arm on arm."""

from __future__ import annotations

from generated.conversions import arm_segment, joint
from generated.handlers.wrist import WristHandler
from generated.messages import Arm
from generated.pb2 import arm_pb2
from roverlink.runtime.core.handler import Handler, Route


class ArmHandler(Handler[arm_pb2.Arm, Arm]):
    """Arm to the topic arm."""

    route = Route(number=1, name="arm", topic="arm", direction="board_to_ros")
    payload_type = arm_pb2.Arm
    message_type = Arm

    @staticmethod
    def to_ros(payload: arm_pb2.Arm) -> Arm:
        """The message that says what the payload says."""
        return Arm(
            upper=arm_segment.to_ros(payload.upper),
            others=[arm_segment.to_ros(item) for item in payload.others],
            elbow=joint.to_ros(payload.elbow),
            wrist=WristHandler.to_ros(payload.wrist),
        )

    @staticmethod
    def from_ros(message: Arm) -> arm_pb2.Arm:
        """The payload that says what the message says."""
        return arm_pb2.Arm(
            upper=arm_segment.from_ros(message.upper),
            others=[arm_segment.from_ros(item) for item in message.others],
            elbow=joint.from_ros(message.elbow),
            wrist=WristHandler.from_ros(message.wrist),
        )
