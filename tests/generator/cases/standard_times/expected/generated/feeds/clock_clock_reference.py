# Generated from mapping.yaml (row clock) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""clock (1): Clock to sensor_msgs/msg/TimeReference on clock/reference."""

from __future__ import annotations

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed, nanoseconds
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(
    sensor_msgs.TimeReference(header=std_msgs.Header(frame_id="gps")),
    ["header.stamp", "time_ref"],
)
_UP_TO_HEADER_STAMP_SEC, _UP_TO_TIME_REF_SEC, _REST = _CDR.constants
_PACK = _CDR.layout.pack


class ClockClockReferenceFeed(Feed[board_pb2.Clock, sensor_msgs.TimeReference]):
    """Clock to sensor_msgs/TimeReference on the topic clock/reference."""

    route = Route(
        number=1,
        name="clock",
        topic="clock/reference",
        direction="board_to_ros",
    )
    payload_type = board_pb2.Clock
    message_type = sensor_msgs.TimeReference

    @staticmethod
    def to_ros(
        payload: board_pb2.Clock,
        _stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.TimeReference:
        """The message that says what the payload says."""
        return sensor_msgs.TimeReference(
            header=std_msgs.Header(
                stamp=Time(
                    *divmod(round(payload.uptime * 1_000_000_000.0), 1_000_000_000),
                ),
                frame_id="gps",
            ),
            time_ref=Time(*divmod(payload.utc_ms * 1_000_000, 1_000_000_000)),
        )

    @staticmethod
    def from_ros(message: sensor_msgs.TimeReference) -> board_pb2.Clock:
        """The payload that says what the message says.

        It says nothing of span_us, utc_ns, seconds.
        """
        return board_pb2.Clock(
            uptime=nanoseconds(message.header.stamp) / 1_000_000_000.0,
            utc_ms=nanoseconds(message.time_ref) // 1_000_000,
        )

    def pack(self, payload: board_pb2.Clock, _stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        sec, nanosec = divmod(round(payload.uptime * 1_000_000_000.0), 1_000_000_000)
        sec1, nanosec1 = divmod(payload.utc_ms * 1_000_000, 1_000_000_000)
        return _PACK(
            _UP_TO_HEADER_STAMP_SEC,
            sec,
            nanosec,
            _UP_TO_TIME_REF_SEC,
            sec1,
            nanosec1,
            _REST,
        )
