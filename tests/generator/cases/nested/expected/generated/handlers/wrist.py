# Generated from mapping.yaml (row wrist) and joint.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row wrist: Wrist and rover/msg/Wrist."""

from __future__ import annotations

from generated.conversions import joint
from generated.messages import Wrist
from generated.pb2 import joint_pb2
from roverlink.runtime.core.handler import Handler, Route


class WristHandler(Handler[joint_pb2.Wrist, Wrist]):
    """Wrist as rover/msg/Wrist.

    Number 2 of the envelope, board_to_ros, topic wrist.
    """

    route = Route(
        number=2,
        name="wrist",
        topic="wrist",
        direction="board_to_ros",
    )
    payload_type = joint_pb2.Wrist
    message_type = Wrist

    @staticmethod
    def to_ros(payload: joint_pb2.Wrist) -> Wrist:
        """Convert Wrist to rover/msg/Wrist."""
        return Wrist(
            roll=joint.to_ros(payload.roll),
            pitch=joint.to_ros(payload.pitch),
            locked=payload.locked,
        )

    @staticmethod
    def from_ros(message: Wrist) -> joint_pb2.Wrist:
        """Convert rover/msg/Wrist to Wrist."""
        return joint_pb2.Wrist(
            roll=joint.from_ros(message.roll),
            pitch=joint.from_ros(message.pitch),
            locked=message.locked,
        )
