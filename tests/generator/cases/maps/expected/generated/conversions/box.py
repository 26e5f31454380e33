# Generated from mapping.yaml and stock.proto; do not edit.
# Regenerate with: roverlink generate
"""Box to and from rover/msg/Box."""

from __future__ import annotations

from generated.messages import Box, BoxContentsEntry
from generated.pb2 import stock_pb2
from roverlink.runtime.convert.maps import mapping


def to_ros(payload: stock_pb2.Box) -> Box:
    """The message that says what the payload says."""
    return Box(
        weight=payload.weight,
        contents=[
            BoxContentsEntry(key=key, value=value)
            for key, value in sorted(payload.contents.items())
        ],
    )


def from_ros(message: Box) -> stock_pb2.Box:
    """The payload that says what the message says."""
    return stock_pb2.Box(
        weight=message.weight,
        contents=mapping(
            ((item.key, item.value) for item in message.contents),
            "Box.contents",
        ),
    )
