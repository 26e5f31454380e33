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
from runtime.registry import Peer, Registry

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
    fingerprint="ee0b824c859722ca4ca4c24291a7ccd6718e2a4609f49739e5530854778d60df",
    retired={},
)
