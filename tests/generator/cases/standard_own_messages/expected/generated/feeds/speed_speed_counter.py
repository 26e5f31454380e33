# Generated from mapping.yaml (row speed) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""speed (2): Velocity to std_msgs/msg/UInt32 on speed/counter."""

from __future__ import annotations

from generated.interfaces import std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(std_msgs.UInt32_(), ["data"])
(_UP_TO_DATA,) = _CDR.constants
_PACK = _CDR.layout.pack


class SpeedSpeedCounterFeed(Feed[board_pb2.Velocity, std_msgs.UInt32_]):
    """Velocity to std_msgs/UInt32 on the topic speed/counter."""

    route = Route(
        number=2,
        name="speed",
        topic="speed/counter",
        direction="board_to_ros",
    )
    payload_type = board_pb2.Velocity
    message_type = std_msgs.UInt32_

    @staticmethod
    def to_ros(
        payload: board_pb2.Velocity,
        _stamp: Time = UNSTAMPED,
    ) -> std_msgs.UInt32_:
        """The message that says what the payload says."""
        return std_msgs.UInt32_(data=payload.sequence)

    @staticmethod
    def from_ros(message: std_msgs.UInt32_) -> board_pb2.Velocity:
        """The payload that says what the message says.

        It says nothing of forward, turn.
        """
        return board_pb2.Velocity(sequence=message.data)

    def pack(self, payload: board_pb2.Velocity, _stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(_UP_TO_DATA, payload.sequence)
