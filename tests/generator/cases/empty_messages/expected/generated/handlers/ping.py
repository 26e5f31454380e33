# Generated from mapping.yaml (row ping) and empty.proto; do not edit.
# Regenerate with: roverlink generate
"""ping (1): Ping to rover/msg/Ping on ping."""

from __future__ import annotations

from generated.messages import Ping
from generated.pb2 import empty_pb2
from roverlink.runtime.core.handler import Handler, Route


class PingHandler(Handler[empty_pb2.Ping, Ping]):
    """Ping to the topic ping."""

    route = Route(number=1, name="ping", topic="ping", direction="board_to_ros")
    payload_type = empty_pb2.Ping
    message_type = Ping

    @staticmethod
    def to_ros(_payload: empty_pb2.Ping) -> Ping:
        """The message that says what the payload says."""
        return Ping()

    @staticmethod
    def from_ros(_message: Ping) -> empty_pb2.Ping:
        """The payload that says what the message says."""
        return empty_pb2.Ping()
