# Generated from mapping.yaml and box.proto; do not edit.
# Regenerate with: roverlink generate
"""Box to and from rover/msg/BoxLevel3."""

from __future__ import annotations

from generated.conversions import box_level3_content
from generated.messages import BoxLevel3
from generated.pb2 import box_pb2


def to_ros(payload: box_pb2.Box) -> BoxLevel3:
    """The message that says what the payload says."""
    return BoxLevel3(x=payload.x, content=box_level3_content.to_ros(payload.content))


def from_ros(message: BoxLevel3) -> box_pb2.Box:
    """The payload that says what the message says."""
    return box_pb2.Box(
        x=message.x,
        content=box_level3_content.from_ros(message.content),
    )
