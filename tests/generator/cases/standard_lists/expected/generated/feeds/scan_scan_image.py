# Generated from mapping.yaml (row scan) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""scan (1): Scan to sensor_msgs/msg/CompressedImage on scan/image."""

from __future__ import annotations

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core.feed import UNSTAMPED, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time


class ScanScanImageFeed(Feed[board_pb2.Scan, sensor_msgs.CompressedImage]):
    """Scan to sensor_msgs/CompressedImage on the topic scan/image."""

    route = Route(number=1, name="scan", topic="scan/image", direction="board_to_ros")
    payload_type = board_pb2.Scan
    message_type = sensor_msgs.CompressedImage

    @staticmethod
    def to_ros(
        payload: board_pb2.Scan,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.CompressedImage:
        """The message that says what the payload says."""
        return sensor_msgs.CompressedImage(
            header=std_msgs.Header(stamp=stamp, frame_id="camera"),
            format=payload.format,
            data=payload.raw,
        )

    @staticmethod
    def from_ros(message: sensor_msgs.CompressedImage) -> board_pb2.Scan:
        """The payload that says what the message says.

        It says nothing of step, ranges_mm, strengths, ok.
        """
        return board_pb2.Scan(format=message.format, raw=message.data)
