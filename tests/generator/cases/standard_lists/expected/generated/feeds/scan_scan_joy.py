# Generated from mapping.yaml (row scan) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""scan (1): Scan to sensor_msgs/msg/Joy on scan/joy."""

from __future__ import annotations

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core.feed import UNSTAMPED, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time


class ScanScanJoyFeed(Feed[board_pb2.Scan, sensor_msgs.Joy]):
    """Scan to sensor_msgs/Joy on the topic scan/joy."""

    route = Route(number=1, name="scan", topic="scan/joy", direction="board_to_ros")
    payload_type = board_pb2.Scan
    message_type = sensor_msgs.Joy

    @staticmethod
    def to_ros(payload: board_pb2.Scan, stamp: Time = UNSTAMPED) -> sensor_msgs.Joy:
        """The message that says what the payload says."""
        return sensor_msgs.Joy(
            header=std_msgs.Header(stamp=stamp, frame_id="hand"),
            axes=list(payload.strengths),
            buttons=list(payload.ranges_mm),
        )

    @staticmethod
    def from_ros(message: sensor_msgs.Joy) -> board_pb2.Scan:
        """The payload that says what the message says.

        It says nothing of step, format, raw, ok.
        """
        return board_pb2.Scan(strengths=message.axes, ranges_mm=message.buttons)
