# Generated from mapping.yaml (row left) and wheel.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row left: Wheel and rover/msg/WheelState."""

from __future__ import annotations

from generated.messages import WheelState
from generated.pb2 import wheel_pb2
from roverlink.runtime.core.handler import Handler, Route


class LeftHandler(Handler[wheel_pb2.Wheel, WheelState]):
    """Wheel as rover/msg/WheelState.

    Number 1 of the envelope, board_to_ros, topic left.
    """

    route = Route(
        number=1,
        name="left",
        topic="left",
        direction="board_to_ros",
    )
    payload_type = wheel_pb2.Wheel
    message_type = WheelState

    @staticmethod
    def to_ros(payload: wheel_pb2.Wheel) -> WheelState:
        """Convert Wheel to rover/msg/WheelState."""
        return WheelState(
            speed=payload.rpm,
        )

    @staticmethod
    def from_ros(message: WheelState) -> wheel_pb2.Wheel:
        """Convert rover/msg/WheelState to Wheel."""
        return wheel_pb2.Wheel(
            rpm=message.speed,
        )
