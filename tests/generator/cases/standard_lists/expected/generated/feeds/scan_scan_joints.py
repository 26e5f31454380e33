# Generated from mapping.yaml (row scan) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""scan (1): Scan to sensor_msgs/msg/JointState on scan/joints."""

from __future__ import annotations

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core.feed import UNSTAMPED, Feed, single
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time


class ScanScanJointsFeed(Feed[board_pb2.Scan, sensor_msgs.JointState]):
    """Scan to sensor_msgs/JointState on the topic scan/joints."""

    route = Route(number=1, name="scan", topic="scan/joints", direction="board_to_ros")
    payload_type = board_pb2.Scan
    message_type = sensor_msgs.JointState

    @staticmethod
    def to_ros(
        payload: board_pb2.Scan,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.JointState:
        """The message that says what the payload says."""
        return sensor_msgs.JointState(
            header=std_msgs.Header(stamp=stamp, frame_id="base"),
            position=list(payload.strengths),
        )

    @staticmethod
    def from_ros(message: sensor_msgs.JointState) -> board_pb2.Scan:
        """The payload that says what the message says.

        It says nothing of step, ranges_mm, format, raw, ok.
        """
        return board_pb2.Scan(strengths=[single(item) for item in message.position])
