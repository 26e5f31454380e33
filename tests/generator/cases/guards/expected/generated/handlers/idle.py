# Generated from mapping.yaml (row idle) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row idle: Idle and rover/msg/Idle."""

from __future__ import annotations

from generated.messages import Idle
from generated.pb2 import all_pb2
from roverlink.runtime.core.handler import Deadman, Handler, Route


class IdleHandler(Handler[all_pb2.Idle, Idle]):
    """Idle as rover/msg/Idle.

    Number 3 of the envelope, ros_to_board, topic idle.
    """

    route = Route(
        number=3,
        name="idle",
        topic="idle",
        direction="ros_to_board",
        deadman=Deadman(
            after_ms=10,
            repeat_ms=1000,
            send={},
        ),
    )
    payload_type = all_pb2.Idle
    message_type = Idle

    @staticmethod
    def to_ros(_payload: all_pb2.Idle) -> Idle:
        """Convert Idle to rover/msg/Idle."""
        return Idle()

    @staticmethod
    def from_ros(_message: Idle) -> all_pb2.Idle:
        """Convert rover/msg/Idle to Idle."""
        return all_pb2.Idle()
