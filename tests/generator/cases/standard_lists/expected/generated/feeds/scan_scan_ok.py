# Generated from mapping.yaml (row scan) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""scan (1): Scan to std_msgs/msg/Bool on scan/ok."""

from __future__ import annotations

from generated.interfaces import std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(std_msgs.Bool_(), ["data"])
(_UP_TO_DATA,) = _CDR.constants
_PACK = _CDR.layout.pack


class ScanScanOkFeed(Feed[board_pb2.Scan, std_msgs.Bool_]):
    """Scan to std_msgs/Bool on the topic scan/ok."""

    route = Route(number=1, name="scan", topic="scan/ok", direction="board_to_ros")
    payload_type = board_pb2.Scan
    message_type = std_msgs.Bool_

    @staticmethod
    def to_ros(payload: board_pb2.Scan, _stamp: Time = UNSTAMPED) -> std_msgs.Bool_:
        """The message that says what the payload says."""
        return std_msgs.Bool_(data=payload.ok)

    @staticmethod
    def from_ros(message: std_msgs.Bool_) -> board_pb2.Scan:
        """The payload that says what the message says.

        It says nothing of step, ranges_mm, strengths, format, raw.
        """
        return board_pb2.Scan(ok=message.data)

    def pack(self, payload: board_pb2.Scan, _stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(_UP_TO_DATA, payload.ok)
