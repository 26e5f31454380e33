# Generated from mapping.yaml and fix.proto; do not edit.
# Regenerate with: roverlink generate
"""Convert between the nested messages Position and rover/msg/Position."""

from __future__ import annotations

from generated.messages import Position
from generated.pb2 import fix_pb2


def to_ros(payload: fix_pb2.Position) -> Position:
    """Convert Position to rover/msg/Position."""
    return Position(
        x=payload.x,
        has_y=payload.HasField("y"),
        y=payload.y,
    )


def from_ros(message: Position) -> fix_pb2.Position:
    """Convert rover/msg/Position to Position."""
    return fix_pb2.Position(
        x=message.x,
        y=message.y if message.has_y else None,
    )
