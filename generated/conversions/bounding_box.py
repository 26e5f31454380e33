# Generated from mapping.yaml and components/basestation/detected_object.proto; do not edit.
# Regenerate with: roverlink generate
"""Convert between the nested messages BoundingBox and comms/msg/BoundingBox."""

from __future__ import annotations

from generated.messages import BoundingBox
from generated.pb2.components.basestation import detected_object_pb2


def to_ros(payload: detected_object_pb2.BoundingBox) -> BoundingBox:
    """Convert BoundingBox to comms/msg/BoundingBox."""
    return BoundingBox(
        x=payload.x,
        y=payload.y,
        width=payload.width,
        height=payload.height,
    )


def from_ros(message: BoundingBox) -> detected_object_pb2.BoundingBox:
    """Convert comms/msg/BoundingBox to BoundingBox."""
    return detected_object_pb2.BoundingBox(
        x=message.x,
        y=message.y,
        width=message.width,
        height=message.height,
    )
