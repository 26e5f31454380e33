# Generated from mapping.yaml and tree.proto; do not edit.
# Regenerate with: roverlink generate
"""Sum to and from rover/msg/SumLevel2."""

from __future__ import annotations

from generated.messages import SumLevel2
from generated.pb2 import tree_pb2
from runtime import depth


def to_ros(payload: tree_pb2.Sum) -> SumLevel2:
    """The message that says what the payload says."""
    depth.check_end(payload, "parts")
    return SumLevel2()


def from_ros(_message: SumLevel2) -> tree_pb2.Sum:
    """The payload that says what the message says."""
    return tree_pb2.Sum()
