# Generated from mapping.yaml (row scan) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""scan (1): Scan to sensor_msgs/msg/LaserScan on scan/laser."""

from __future__ import annotations

import math

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core.feed import UNSTAMPED, Feed, single
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_DEG_TO_RAD = math.pi / 180


class ScanScanLaserFeed(Feed[board_pb2.Scan, sensor_msgs.LaserScan]):
    """Scan to sensor_msgs/LaserScan on the topic scan/laser."""

    route = Route(number=1, name="scan", topic="scan/laser", direction="board_to_ros")
    payload_type = board_pb2.Scan
    message_type = sensor_msgs.LaserScan

    @staticmethod
    def to_ros(
        payload: board_pb2.Scan,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.LaserScan:
        """The message that says what the payload says."""
        return sensor_msgs.LaserScan(
            header=std_msgs.Header(stamp=stamp, frame_id="laser"),
            angle_min=-1.5,
            angle_max=1.5,
            angle_increment=payload.step * _DEG_TO_RAD,
            time_increment=0.0,
            scan_time=0.1,
            range_min=0.05,
            range_max=10.0,
            ranges=[item / 1_000.0 for item in payload.ranges_mm],
            intensities=list(payload.strengths),
        )

    @staticmethod
    def from_ros(message: sensor_msgs.LaserScan) -> board_pb2.Scan:
        """The payload that says what the message says.

        It says nothing of format, raw, ok.
        """
        return board_pb2.Scan(
            step=single(message.angle_increment / _DEG_TO_RAD),
            ranges_mm=[round(item * 1_000.0) for item in message.ranges],
            strengths=message.intensities,
        )
