# Generated from mapping.yaml (row single) and tree.proto; do not edit.
# Regenerate with: roverlink generate
"""single (5): Single to rover/msg/Single on single."""

from __future__ import annotations

from generated.messages import Single
from generated.pb2 import tree_pb2
from runtime import depth
from runtime.handler import Handler, Route


class SingleHandler(Handler[tree_pb2.Single, Single]):
    """Single to the topic single."""

    route = Route(number=5, name="single", topic="single", direction="board_to_ros")
    payload_type = tree_pb2.Single
    message_type = Single

    @staticmethod
    def to_ros(payload: tree_pb2.Single) -> Single:
        """The message that says what the payload says."""
        depth.check_end(payload, "more")
        return Single(x=payload.x)

    @staticmethod
    def from_ros(message: Single) -> tree_pb2.Single:
        """The payload that says what the message says."""
        return tree_pb2.Single(x=message.x)
