# Generated from mapping.yaml and rover/drive/state.proto; do not edit.
# Regenerate with: roverlink generate
"""Convert between the nested messages State.Inner and rover/msg/StateInner."""

from __future__ import annotations

from generated.messages import StateInner
from generated.pb2.rover.drive import state_pb2


def to_ros(payload: state_pb2.State.Inner) -> StateInner:
    """Convert State.Inner to rover/msg/StateInner."""
    return StateInner(
        y=payload.y,
    )


def from_ros(message: StateInner) -> state_pb2.State.Inner:
    """Convert rover/msg/StateInner to State.Inner."""
    return state_pb2.State.Inner(
        y=message.y,
    )
