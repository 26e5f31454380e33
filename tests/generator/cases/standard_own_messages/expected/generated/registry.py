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
from roverlink.runtime.core.registry import Peer, Registry

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
    fingerprint="3e58315e78fd998f03c4f32ad21cec5f6ba6a4186d4c40fcb0cf99483e9b8e07",
    retired={},
)
