# Generated from mapping.yaml (row right) and wheel.proto; do not edit.
# Regenerate with: roverlink generate
"""right (2): Wheel from rover/msg/WheelState on right."""

from __future__ import annotations

from generated.messages import WheelState
from generated.pb2 import wheel_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(WheelState)


class RightHandler(Handler[wheel_pb2.Wheel, WheelState]):
    """Wheel from the topic right."""

    route = Route(number=2, name="right", topic="right", direction="ros_to_board")
    payload_type = wheel_pb2.Wheel
    message_type = WheelState

    @staticmethod
    def to_ros(payload: wheel_pb2.Wheel) -> WheelState:
        """The message that says what the payload says."""
        return WheelState(speed=payload.rpm)

    @staticmethod
    def from_ros(message: WheelState) -> wheel_pb2.Wheel:
        """The payload that says what the message says."""
        return wheel_pb2.Wheel(rpm=message.speed)

    def pack(self, payload: wheel_pb2.Wheel) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.rpm)
