# Generated from mapping.yaml (row wrist) and joint.proto; do not edit.
# Regenerate with: roverlink generate
"""wrist (2): Wrist to rover/msg/Wrist on wrist."""

from __future__ import annotations

from generated.conversions import joint
from generated.messages import Wrist
from generated.pb2 import joint_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(Wrist)


class WristHandler(Handler[joint_pb2.Wrist, Wrist]):
    """Wrist to the topic wrist."""

    route = Route(number=2, name="wrist", topic="wrist", direction="board_to_ros")
    payload_type = joint_pb2.Wrist
    message_type = Wrist

    @staticmethod
    def to_ros(payload: joint_pb2.Wrist) -> Wrist:
        """The message that says what the payload says."""
        return Wrist(
            roll=joint.to_ros(payload.roll),
            pitch=joint.to_ros(payload.pitch),
            locked=payload.locked,
        )

    @staticmethod
    def from_ros(message: Wrist) -> joint_pb2.Wrist:
        """The payload that says what the message says."""
        return joint_pb2.Wrist(
            roll=joint.from_ros(message.roll),
            pitch=joint.from_ros(message.pitch),
            locked=message.locked,
        )

    def pack(self, payload: joint_pb2.Wrist) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        roll = payload.roll
        pitch = payload.pitch
        return _CDR.pack(cdr.LITTLE_ENDIAN, roll.angle, pitch.angle, payload.locked)
