# Generated from mapping.yaml and tree.proto; do not edit.
# Regenerate with: roverlink generate
"""Tree to and from rover/msg/TreeLevel3."""

from __future__ import annotations

from generated.conversions import branch_level3
from generated.messages import TreeLevel3
from generated.pb2 import tree_pb2


def to_ros(payload: tree_pb2.Tree) -> TreeLevel3:
    """The message that says what the payload says."""
    return TreeLevel3(
        name=payload.name,
        branches=[branch_level3.to_ros(item) for item in payload.branches],
    )


def from_ros(message: TreeLevel3) -> tree_pb2.Tree:
    """The payload that says what the message says."""
    return tree_pb2.Tree(
        name=message.name,
        branches=[branch_level3.from_ros(item) for item in message.branches],
    )
