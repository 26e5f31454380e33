# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Every row's handler, with the envelope they travel in."""

from __future__ import annotations

from generated.feeds import DriveDriveTwistFeed, SpeedSpeedCounterFeed
from generated.handlers import (
    CmdVelHandler,
    DriveHandler,
    SpeedHandler,
    VelocityHandler,
)
from generated.pb2 import envelope_pb2
from runtime.registry import Peer, Registry

REGISTRY = Registry(
    package="rover",
    envelope=envelope_pb2.Envelope,
    oneof="payload",
    peers=(Peer(name="board", port_parameter="dst_a_port", port=6000),),
    handlers=(
        CmdVelHandler(),
        SpeedHandler(),
        DriveHandler(),
        VelocityHandler(),
    ),
    feeds=(
        SpeedSpeedCounterFeed(),
        DriveDriveTwistFeed(),
    ),
    fingerprint="ca5ee6f286ef24c293877b445e95aa832ee911657f213c17359efc13a95eefcd",
    retired={},
)
