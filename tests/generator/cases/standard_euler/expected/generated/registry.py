# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Every row's handler, with the envelope they travel in."""

from __future__ import annotations

from generated.feeds import LevelLevelPoseFeed
from generated.handlers import AttitudeHandler, LevelHandler, PoseHandler
from generated.pb2 import envelope_pb2
from roverlink.runtime.core.registry import Peer, Registry

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
    fingerprint="eccfff9e781f5f72551873db1897a93691fff2aa1b4b257741219e2ad4448cad",
    retired={},
)
