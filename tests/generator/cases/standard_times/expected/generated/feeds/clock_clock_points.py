# Generated from mapping.yaml (row clock) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""clock (1): Clock to geometry_msgs/msg/PointStamped on clock/points."""

from __future__ import annotations

from generated.interfaces import geometry_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed, nanoseconds
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(
    geometry_msgs.PointStamped(
        header=std_msgs.Header(frame_id="map"),
        point=geometry_msgs.Point(x=0.0, y=0.0, z=0.0),
    ),
    ["header.stamp"],
)
_UP_TO_HEADER_STAMP_SEC, _REST = _CDR.constants
_PACK = _CDR.layout.pack


class ClockClockPointsFeed(Feed[board_pb2.Clock, geometry_msgs.PointStamped]):
    """Clock to geometry_msgs/PointStamped on the topic clock/points."""

    route = Route(
        number=1,
        name="clock",
        topic="clock/points",
        direction="board_to_ros",
    )
    payload_type = board_pb2.Clock
    message_type = geometry_msgs.PointStamped

    @staticmethod
    def to_ros(
        payload: board_pb2.Clock,
        _stamp: Time = UNSTAMPED,
    ) -> geometry_msgs.PointStamped:
        """The message that says what the payload says."""
        return geometry_msgs.PointStamped(
            header=std_msgs.Header(
                stamp=Time(*divmod(payload.utc_ns, 1_000_000_000)),
                frame_id="map",
            ),
            point=geometry_msgs.Point(x=0.0, y=0.0, z=0.0),
        )

    @staticmethod
    def from_ros(message: geometry_msgs.PointStamped) -> board_pb2.Clock:
        """The payload that says what the message says.

        It says nothing of uptime, utc_ms, span_us, seconds.
        """
        return board_pb2.Clock(utc_ns=nanoseconds(message.header.stamp))

    def pack(self, payload: board_pb2.Clock, _stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        sec, nanosec = divmod(payload.utc_ns, 1_000_000_000)
        return _PACK(_UP_TO_HEADER_STAMP_SEC, sec, nanosec, _REST)
