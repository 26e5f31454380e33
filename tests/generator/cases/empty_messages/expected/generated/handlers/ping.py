# Generated from mapping.yaml (row ping) and empty.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row ping: Ping and rover/msg/Ping."""

from __future__ import annotations

from generated.messages import Ping
from generated.pb2 import empty_pb2
from roverlink.runtime.core.handler import Handler, Route


class PingHandler(Handler[empty_pb2.Ping, Ping]):
    """Ping as rover/msg/Ping.

    Number 1 of the envelope, board_to_ros, topic ping.
    """

    route = Route(
        number=1,
        name="ping",
        topic="ping",
        direction="board_to_ros",
    )
    payload_type = empty_pb2.Ping
    message_type = Ping

    @staticmethod
    def to_ros(_payload: empty_pb2.Ping) -> Ping:
        """Convert Ping to rover/msg/Ping."""
        return Ping()

    @staticmethod
    def from_ros(_message: Ping) -> empty_pb2.Ping:
        """Convert rover/msg/Ping to Ping."""
        return empty_pb2.Ping()
