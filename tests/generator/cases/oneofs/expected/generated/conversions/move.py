# Generated from mapping.yaml and command.proto; do not edit.
# Regenerate with: roverlink generate
"""Convert between the nested messages Move and rover/msg/Move."""

from __future__ import annotations

from generated.messages import Move
from generated.pb2 import command_pb2
from roverlink.runtime.convert import oneof

WHICH_HOW_MEMBERS = {
    "speed": Move.HOW_SPEED,
    "seconds": Move.HOW_SECONDS,
}


def to_ros(payload: command_pb2.Move) -> Move:
    """Convert Move to rover/msg/Move."""
    return Move(
        x=payload.x,
        which_how=oneof.number(payload, "how", WHICH_HOW_MEMBERS),
        speed=payload.speed,
        seconds=payload.seconds,
    )


def from_ros(message: Move) -> command_pb2.Move:
    """Convert rover/msg/Move to Move."""
    which_how = oneof.member(message.which_how, WHICH_HOW_MEMBERS, "Move.which_how")
    return command_pb2.Move(
        x=message.x,
        speed=message.speed if which_how == "speed" else None,
        seconds=message.seconds if which_how == "seconds" else None,
    )
