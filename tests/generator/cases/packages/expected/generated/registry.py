# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Every row's handler, with the envelope they travel in."""

from __future__ import annotations

from generated.handlers import (
    ArmStateHandler,
    DriveStateHandler,
    InnerHandler,
    TopHandler,
)
from generated.pb2.rover.link import envelope_pb2
from roverlink.runtime.core.registry import Peer, Registry

REGISTRY = Registry(
    package="rover",
    envelope=envelope_pb2.Envelope,
    oneof="body",
    peers=(Peer(name="board", port_parameter="dst_a_port", port=6000),),
    handlers=(
        ArmStateHandler(),
        DriveStateHandler(),
        TopHandler(),
        InnerHandler(),
    ),
    fingerprint="7e9ff931109066f97af5280b2db366f455bf645d94638270d72fdcb6287c67ed",
    retired={},
)
