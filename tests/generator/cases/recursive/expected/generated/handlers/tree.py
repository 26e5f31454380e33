# Generated from mapping.yaml (row tree) and tree.proto; do not edit.
# Regenerate with: roverlink generate
"""tree (1): Tree to rover/msg/Tree on tree."""

from __future__ import annotations

from generated.handlers.branch import BranchHandler
from generated.messages import Tree
from generated.pb2 import tree_pb2
from runtime.handler import Handler, Route


class TreeHandler(Handler[tree_pb2.Tree, Tree]):
    """Tree to the topic tree."""

    route = Route(number=1, name="tree", topic="tree", direction="board_to_ros")
    payload_type = tree_pb2.Tree
    message_type = Tree

    @staticmethod
    def to_ros(payload: tree_pb2.Tree) -> Tree:
        """The message that says what the payload says."""
        return Tree(
            name=payload.name,
            branches=[BranchHandler.to_ros(item) for item in payload.branches],
        )

    @staticmethod
    def from_ros(message: Tree) -> tree_pb2.Tree:
        """The payload that says what the message says."""
        return tree_pb2.Tree(
            name=message.name,
            branches=[BranchHandler.from_ros(item) for item in message.branches],
        )
