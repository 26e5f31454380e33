# Generated from mapping.yaml and rover/drive/state.proto; do not edit.
# Regenerate with: roverlink generate
"""State.Inner to and from rover/msg/StateInner."""

from __future__ import annotations

from generated.messages import StateInner
from generated.pb2.rover.drive import state_pb2


def to_ros(payload: state_pb2.State.Inner) -> StateInner:
    """The message that says what the payload says."""
    return StateInner(y=payload.y)


def from_ros(message: StateInner) -> state_pb2.State.Inner:
    """The payload that says what the message says."""
    return state_pb2.State.Inner(y=message.y)
