# Generated from mapping.yaml and empty.proto; do not edit.
# Regenerate with: roverlink generate
"""Convert between the nested messages Nothing and rover/msg/Nothing."""

from __future__ import annotations

from generated.messages import Nothing
from generated.pb2 import empty_pb2


def to_ros(_payload: empty_pb2.Nothing) -> Nothing:
    """Convert Nothing to rover/msg/Nothing."""
    return Nothing()


def from_ros(_message: Nothing) -> empty_pb2.Nothing:
    """Convert rover/msg/Nothing to Nothing."""
    return empty_pb2.Nothing()
