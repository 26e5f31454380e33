# Generated from mapping.yaml and empty.proto; do not edit.
# Regenerate with: roverlink generate
"""Nothing to and from rover/msg/Nothing."""

from __future__ import annotations

from generated.messages import Nothing
from generated.pb2 import empty_pb2


def to_ros(_payload: empty_pb2.Nothing) -> Nothing:
    """The message that says what the payload says."""
    return Nothing()


def from_ros(_message: Nothing) -> empty_pb2.Nothing:
    """The payload that says what the message says."""
    return empty_pb2.Nothing()
