# Generated from mapping.yaml (row speed) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""speed (2): Velocity to std_msgs/msg/Float32 on speed."""

from __future__ import annotations

from generated.interfaces import std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(std_msgs.Float32_(), ["data"])
(_UP_TO_DATA,) = _CDR.constants
_PACK = _CDR.layout.pack


class SpeedHandler(Feed[board_pb2.Velocity, std_msgs.Float32_]):
    """Velocity to std_msgs/Float32 on the topic speed."""

    route = Route(number=2, name="speed", topic="speed", direction="board_to_ros")
    payload_type = board_pb2.Velocity
    message_type = std_msgs.Float32_

    @staticmethod
    def to_ros(
        payload: board_pb2.Velocity,
        _stamp: Time = UNSTAMPED,
    ) -> std_msgs.Float32_:
        """The message that says what the payload says."""
        return std_msgs.Float32_(data=payload.forward)

    @staticmethod
    def from_ros(message: std_msgs.Float32_) -> board_pb2.Velocity:
        """The payload that says what the message says."""
        return board_pb2.Velocity(forward=message.data)

    def pack(self, payload: board_pb2.Velocity, _stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(_UP_TO_DATA, payload.forward)
