# Generated from mapping.yaml and any.proto; do not edit.
# Regenerate with: roverlink generate
"""Oneof to and from rover/msg/Oneof."""

from __future__ import annotations

from generated.messages import Oneof
from generated.pb2 import any_pb2
from roverlink.runtime.convert import oneof

_WHICH_ONEOF = {"one": Oneof.ONEOF_ONE}


def to_ros(payload: any_pb2.Oneof) -> Oneof:
    """The message that says what the payload says."""
    return Oneof(
        which_oneof=oneof.number(payload, "oneof", _WHICH_ONEOF),
        one=payload.one,
    )


def from_ros(message: Oneof) -> any_pb2.Oneof:
    """The payload that says what the message says."""
    which_oneof = oneof.member(message.which_oneof, _WHICH_ONEOF, "Oneof.which_oneof")
    return any_pb2.Oneof(one=message.one if which_oneof == "one" else None)
