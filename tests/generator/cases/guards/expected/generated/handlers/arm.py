# Generated from mapping.yaml (row arm) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""arm (2): Arm from rover/msg/Arm on arm."""

from __future__ import annotations

from generated.conversions import grip
from generated.messages import Arm
from generated.pb2 import all_pb2
from roverlink.runtime.core.handler import Deadman, Handler, Route


class ArmHandler(Handler[all_pb2.Arm, Arm]):
    """Arm from the topic arm."""

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
        """The message that says what the payload says."""
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
        """The payload that says what the message says."""
        return all_pb2.Arm(
            mode=message.mode,
            grip=grip.from_ros(message.grip),
            text=message.text,
            raw=message.raw,
            steps=message.steps,
            big=message.big,
        )
