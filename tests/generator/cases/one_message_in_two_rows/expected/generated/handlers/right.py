# Generated from mapping.yaml (row right) and wheel.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row right: Wheel and rover/msg/WheelState."""

from __future__ import annotations

from generated.messages import WheelState
from generated.pb2 import wheel_pb2
from roverlink.runtime.core.handler import Handler, Route


class RightHandler(Handler[wheel_pb2.Wheel, WheelState]):
    """Wheel as rover/msg/WheelState.

    Number 2 of the envelope, ros_to_board, topic right.
    """

    route = Route(
        number=2,
        name="right",
        topic="right",
        direction="ros_to_board",
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
