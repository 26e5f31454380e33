# Generated from mapping.yaml and tree.proto; do not edit.
# Regenerate with: roverlink generate
"""Branch to and from rover/msg/BranchLevel3."""

from __future__ import annotations

from generated.messages import BranchLevel3
from generated.pb2 import tree_pb2
from runtime import depth


def to_ros(payload: tree_pb2.Branch) -> BranchLevel3:
    """The message that says what the payload says."""
    depth.check_end(payload, "tree", "grafts")
    return BranchLevel3(length=payload.length)


def from_ros(message: BranchLevel3) -> tree_pb2.Branch:
    """The payload that says what the message says."""
    return tree_pb2.Branch(length=message.length)
