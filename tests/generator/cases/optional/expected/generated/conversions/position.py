# Generated from mapping.yaml and fix.proto; do not edit.
# Regenerate with: roverlink generate
"""Position to and from rover/msg/Position."""

from __future__ import annotations

from generated.messages import Position
from generated.pb2 import fix_pb2


def to_ros(payload: fix_pb2.Position) -> Position:
    """The message that says what the payload says."""
    return Position(x=payload.x, has_y=payload.HasField("y"), y=payload.y)


def from_ros(message: Position) -> fix_pb2.Position:
    """The payload that says what the message says."""
    return fix_pb2.Position(x=message.x, y=message.y if message.has_y else None)
