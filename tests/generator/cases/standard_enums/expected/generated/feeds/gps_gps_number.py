# Generated from mapping.yaml (row gps) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""gps (1): Gps to std_msgs/msg/Int8 on gps/number."""

from __future__ import annotations

from generated.interfaces import std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.core.feed import UNSTAMPED, Counterparts, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_QUALITY = Counterparts(
    "quality",
    {
        0: -1,  # NONE
        1: 1,  # PLAIN
        4: 1,  # RTK
    },
)
_CDR = cdr.template(std_msgs.Int8_(), ["data"])
(_UP_TO_DATA,) = _CDR.constants
_PACK = _CDR.layout.pack


class GpsGpsNumberFeed(Feed[board_pb2.Gps, std_msgs.Int8_]):
    """Gps to std_msgs/Int8 on the topic gps/number."""

    route = Route(number=1, name="gps", topic="gps/number", direction="board_to_ros")
    payload_type = board_pb2.Gps
    message_type = std_msgs.Int8_

    @staticmethod
    def to_ros(payload: board_pb2.Gps, _stamp: Time = UNSTAMPED) -> std_msgs.Int8_:
        """The message that says what the payload says."""
        return std_msgs.Int8_(data=_QUALITY[payload.quality])

    @staticmethod
    def from_ros(_message: std_msgs.Int8_) -> board_pb2.Gps:
        """There is no way back: data is 1 for PLAIN and for RTK of quality."""
        raise ConversionError("data is 1 for PLAIN and for RTK of quality")

    def pack(self, payload: board_pb2.Gps, _stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(_UP_TO_DATA, _QUALITY[payload.quality])
