# Generated from mapping.yaml and command.proto; do not edit.
# Regenerate with: roverlink generate
"""Move to and from rover/msg/Move."""

from __future__ import annotations

from generated.messages import Move
from generated.pb2 import command_pb2
from roverlink.runtime.convert import oneof

_WHICH_HOW = {"speed": Move.HOW_SPEED, "seconds": Move.HOW_SECONDS}


def to_ros(payload: command_pb2.Move) -> Move:
    """The message that says what the payload says."""
    return Move(
        x=payload.x,
        which_how=oneof.number(payload, "how", _WHICH_HOW),
        speed=payload.speed,
        seconds=payload.seconds,
    )


def from_ros(message: Move) -> command_pb2.Move:
    """The payload that says what the message says."""
    which_how = oneof.member(message.which_how, _WHICH_HOW, "Move.which_how")
    return command_pb2.Move(
        x=message.x,
        speed=message.speed if which_how == "speed" else None,
        seconds=message.seconds if which_how == "seconds" else None,
    )
