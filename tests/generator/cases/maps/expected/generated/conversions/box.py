# Generated from mapping.yaml and stock.proto; do not edit.
# Regenerate with: roverlink generate
"""Convert between the nested messages Box and rover/msg/Box."""

from __future__ import annotations

from generated.messages import Box, BoxContentsEntry
from generated.pb2 import stock_pb2
from roverlink.runtime.convert.maps import mapping


def to_ros(payload: stock_pb2.Box) -> Box:
    """Convert Box to rover/msg/Box."""
    return Box(
        weight=payload.weight,
        contents=[
            BoxContentsEntry(key=key, value=value)
            for key, value in sorted(payload.contents.items())
        ],
    )


def from_ros(message: Box) -> stock_pb2.Box:
    """Convert rover/msg/Box to Box."""
    return stock_pb2.Box(
        weight=message.weight,
        contents=mapping(
            ((item.key, item.value) for item in message.contents), "Box.contents"
        ),
    )
