# Generated from mapping.yaml (row chain) and tree.proto; do not edit.
# Regenerate with: roverlink generate
"""chain (2): Chain from rover/msg/Chain on chain."""

from __future__ import annotations

from generated.conversions import chain_level2
from generated.messages import Chain
from generated.pb2 import tree_pb2
from runtime.handler import Handler, Route


class ChainHandler(Handler[tree_pb2.Chain, Chain]):
    """Chain from the topic chain."""

    route = Route(number=2, name="chain", topic="chain", direction="ros_to_board")
    payload_type = tree_pb2.Chain
    message_type = Chain

    @staticmethod
    def to_ros(payload: tree_pb2.Chain) -> Chain:
        """The message that says what the payload says."""
        return Chain(
            link=payload.link,
            has_following=payload.HasField("next"),
            following=chain_level2.to_ros(payload.next),
        )

    @staticmethod
    def from_ros(message: Chain) -> tree_pb2.Chain:
        """The payload that says what the message says."""
        return tree_pb2.Chain(
            link=message.link,
            next=(
                chain_level2.from_ros(message.following)
                if message.has_following
                else None
            ),
        )
