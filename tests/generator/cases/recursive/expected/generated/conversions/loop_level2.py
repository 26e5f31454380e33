# Generated from mapping.yaml and box.proto; do not edit.
# Regenerate with: roverlink generate
"""Loop to and from rover/msg/LoopLevel2."""

from __future__ import annotations

from generated.conversions import leaf
from generated.messages import LoopLevel2
from generated.pb2 import box_pb2
from runtime import depth


def to_ros(payload: box_pb2.Loop) -> LoopLevel2:
    """The message that says what the payload says."""
    depth.check_end(payload, "loops", "knots")
    return LoopLevel2(leaf=leaf.to_ros(payload.leaf))


def from_ros(message: LoopLevel2) -> box_pb2.Loop:
    """The payload that says what the message says."""
    return box_pb2.Loop(leaf=leaf.from_ros(message.leaf))
