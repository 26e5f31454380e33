# Generated from mapping.yaml (row motion) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""motion (1): Motion to geometry_msgs/msg/Point on motion/point."""

from __future__ import annotations

from generated.interfaces import geometry_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(geometry_msgs.Point(z=2.5), ["x", "y"])
_UP_TO_X, _REST = _CDR.constants
_PACK = _CDR.layout.pack


class MotionMotionPointFeed(Feed[board_pb2.Motion, geometry_msgs.Point]):
    """Motion to geometry_msgs/Point on the topic motion/point."""

    route = Route(
        number=1,
        name="motion",
        topic="motion/point",
        direction="board_to_ros",
    )
    payload_type = board_pb2.Motion
    message_type = geometry_msgs.Point

    @staticmethod
    def to_ros(
        payload: board_pb2.Motion,
        _stamp: Time = UNSTAMPED,
    ) -> geometry_msgs.Point:
        """The message that says what the payload says."""
        return geometry_msgs.Point(
            x=-payload.north / 100.0,
            y=-payload.east / 1_000.0,
            z=2.5,
        )

    @staticmethod
    def from_ros(message: geometry_msgs.Point) -> board_pb2.Motion:
        """The payload that says what the message says.

        It says nothing of roll, pitch, yaw.
        """
        return board_pb2.Motion(north=-message.x * 100.0, east=-message.y * 1_000.0)

    def pack(self, payload: board_pb2.Motion, _stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(_UP_TO_X, -payload.north / 100.0, -payload.east / 1_000.0, _REST)
