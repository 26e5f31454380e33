# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Every row's handler, with the envelope they travel in."""

from __future__ import annotations

from generated.feeds import LevelLevelPoseFeed
from generated.handlers import AttitudeHandler, LevelHandler, PoseHandler
from generated.pb2 import envelope_pb2
from runtime.registry import Peer, Registry

REGISTRY = Registry(
    package="rover",
    envelope=envelope_pb2.Envelope,
    oneof="payload",
    peers=(Peer(name="board", port_parameter="dst_a_port", port=6000),),
    handlers=(
        AttitudeHandler(),
        PoseHandler(),
        LevelHandler(),
    ),
    feeds=(LevelLevelPoseFeed(),),
    fingerprint="33c09964987982ab4f94f6ff11198074a35a23740d71cbd456bdd9e66e3b3582",
    retired={},
)
