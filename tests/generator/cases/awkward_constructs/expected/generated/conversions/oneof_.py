# Generated from mapping.yaml and any.proto; do not edit.
# Regenerate with: roverlink generate
"""Convert between the nested messages Oneof and rover/msg/Oneof."""

from __future__ import annotations

from generated.messages import Oneof
from generated.pb2 import any_pb2
from roverlink.runtime.convert import oneof

WHICH_ONEOF_MEMBERS = {
    "one": Oneof.ONEOF_ONE,
}


def to_ros(payload: any_pb2.Oneof) -> Oneof:
    """Convert Oneof to rover/msg/Oneof."""
    return Oneof(
        which_oneof=oneof.number(payload, "oneof", WHICH_ONEOF_MEMBERS),
        one=payload.one,
    )


def from_ros(message: Oneof) -> any_pb2.Oneof:
    """Convert rover/msg/Oneof to Oneof."""
    which_oneof = oneof.member(
        message.which_oneof, WHICH_ONEOF_MEMBERS, "Oneof.which_oneof"
    )
    return any_pb2.Oneof(
        one=message.one if which_oneof == "one" else None,
    )
