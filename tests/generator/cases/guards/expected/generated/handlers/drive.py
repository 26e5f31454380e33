# Generated from mapping.yaml (row drive) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row drive: Drive and rover/msg/Drive."""

from __future__ import annotations

from generated.messages import Drive
from generated.pb2 import all_pb2
from roverlink.runtime.core.handler import Deadman, Handler, Route


class DriveHandler(Handler[all_pb2.Drive, Drive]):
    """Drive as rover/msg/Drive.

    Number 1 of the envelope, ros_to_board, topic drive.
    """

    route = Route(
        number=1,
        name="drive",
        topic="drive",
        direction="ros_to_board",
        deadman=Deadman(
            after_ms=500,
            repeat_ms=1000,
            send={
                "speed": 0.0,
            },
        ),
        max_rate=50,
        priority=9,
    )
    payload_type = all_pb2.Drive
    message_type = Drive

    @staticmethod
    def to_ros(payload: all_pb2.Drive) -> Drive:
        """Convert Drive to rover/msg/Drive."""
        return Drive(
            speed=payload.speed,
        )

    @staticmethod
    def from_ros(message: Drive) -> all_pb2.Drive:
        """Convert rover/msg/Drive to Drive."""
        return all_pb2.Drive(
            speed=message.speed,
        )
