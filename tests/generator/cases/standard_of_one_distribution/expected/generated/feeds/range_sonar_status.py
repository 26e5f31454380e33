# Generated from mapping.yaml (row range) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""range (1): Sonar to sensor_msgs/msg/NavSatStatus on sonar/status."""

from __future__ import annotations

from generated.interfaces import sensor_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core.feed import UNSTAMPED, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time


class RangeSonarStatusFeed(Feed[board_pb2.Sonar, sensor_msgs.NavSatStatus]):
    """Sonar to sensor_msgs/NavSatStatus on the topic sonar/status."""

    route = Route(
        number=1,
        name="range",
        topic="sonar/status",
        direction="board_to_ros",
    )
    payload_type = board_pb2.Sonar
    message_type = sensor_msgs.NavSatStatus

    @staticmethod
    def to_ros(
        _payload: board_pb2.Sonar,
        _stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.NavSatStatus:
        """The message that says what the payload says."""
        return sensor_msgs.NavSatStatus(status=-2, service=0)

    @staticmethod
    def from_ros(_message: sensor_msgs.NavSatStatus) -> board_pb2.Sonar:
        """An empty payload: the message tells none of its fields."""
        return board_pb2.Sonar()
