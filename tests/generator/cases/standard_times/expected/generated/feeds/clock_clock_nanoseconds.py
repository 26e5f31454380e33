# Generated from mapping.yaml (row clock) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""clock (1): Clock to builtin_interfaces/msg/Time on clock/nanoseconds."""

from __future__ import annotations

from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(Time(nanosec=0), ["sec"])
_UP_TO_SEC, _REST = _CDR.constants
_PACK = _CDR.layout.pack


class ClockClockNanosecondsFeed(Feed[board_pb2.Clock, Time]):
    """Clock to builtin_interfaces/Time on the topic clock/nanoseconds."""

    route = Route(
        number=1,
        name="clock",
        topic="clock/nanoseconds",
        direction="board_to_ros",
    )
    payload_type = board_pb2.Clock
    message_type = Time

    @staticmethod
    def to_ros(payload: board_pb2.Clock, _stamp: Time = UNSTAMPED) -> Time:
        """The message that says what the payload says."""
        return Time(sec=payload.seconds, nanosec=0)

    @staticmethod
    def from_ros(message: Time) -> board_pb2.Clock:
        """The payload that says what the message says.

        It says nothing of uptime, utc_ms, span_us, utc_ns.
        """
        return board_pb2.Clock(seconds=message.sec)

    def pack(self, payload: board_pb2.Clock, _stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(_UP_TO_SEC, payload.seconds, _REST)
