# Generated from mapping.yaml (row range) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""range (1): Sonar to sensor_msgs/msg/Range on sonar/range."""

from __future__ import annotations

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(
    sensor_msgs.Range(
        header=std_msgs.Header(frame_id="sonar"),
        radiation_type=0,
        field_of_view=0.3,
        min_range=0.0,
        max_range=4.0,
        variance=0.01,
    ),
    ["header.stamp", "range"],
)
_UP_TO_HEADER_STAMP_SEC, _UP_TO_RANGE, _REST = _CDR.constants
_PACK = _CDR.layout.pack


class RangeSonarRangeFeed(Feed[board_pb2.Sonar, sensor_msgs.Range]):
    """Sonar to sensor_msgs/Range on the topic sonar/range."""

    route = Route(number=1, name="range", topic="sonar/range", direction="board_to_ros")
    payload_type = board_pb2.Sonar
    message_type = sensor_msgs.Range

    @staticmethod
    def to_ros(payload: board_pb2.Sonar, stamp: Time = UNSTAMPED) -> sensor_msgs.Range:
        """The message that says what the payload says."""
        return sensor_msgs.Range(
            header=std_msgs.Header(stamp=stamp, frame_id="sonar"),
            radiation_type=0,
            field_of_view=0.3,
            min_range=0.0,
            max_range=4.0,
            range=payload.distance,
            variance=0.01,
        )

    @staticmethod
    def from_ros(message: sensor_msgs.Range) -> board_pb2.Sonar:
        """The payload that says what the message says."""
        return board_pb2.Sonar(distance=message.range)

    def pack(self, payload: board_pb2.Sonar, stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(
            _UP_TO_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _UP_TO_RANGE,
            payload.distance,
            _REST,
        )
