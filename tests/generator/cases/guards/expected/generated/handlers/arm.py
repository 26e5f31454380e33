# Generated from mapping.yaml (row arm) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row arm: Arm and rover/msg/Arm."""

from __future__ import annotations

from generated.conversions import grip
from generated.messages import Arm
from generated.pb2 import all_pb2
from roverlink.runtime.core.handler import Deadman, Handler, Route


class ArmHandler(Handler[all_pb2.Arm, Arm]):
    """Arm as rover/msg/Arm.

    Number 2 of the envelope, ros_to_board, topic arm.
    """

    route = Route(
        number=2,
        name="arm",
        topic="arm",
        direction="ros_to_board",
        deadman=Deadman(
            after_ms=2000,
            repeat_ms=5000,
            send={
                "mode": 3,
                "grip.force": -0.0015,
                "grip.open": False,
                "text": 'say "stop"',
                "raw": b"\x00\xff",
                "steps": -5,
                "big": 18446744073709551615,
            },
        ),
    )
    payload_type = all_pb2.Arm
    message_type = Arm

    @staticmethod
    def to_ros(payload: all_pb2.Arm) -> Arm:
        """Convert Arm to rover/msg/Arm."""
        return Arm(
            mode=payload.mode,
            grip=grip.to_ros(payload.grip),
            text=payload.text,
            raw=payload.raw,
            steps=payload.steps,
            big=payload.big,
        )

    @staticmethod
    def from_ros(message: Arm) -> all_pb2.Arm:
        """Convert rover/msg/Arm to Arm."""
        return all_pb2.Arm(
            mode=message.mode,
            grip=grip.from_ros(message.grip),
            text=message.text,
            raw=message.raw,
            steps=message.steps,
            big=message.big,
        )
