# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Every row's handler, with the envelope they travel in."""

from __future__ import annotations

from generated.handlers import GpsHandler, ImuHandler
from generated.pb2.link import envelope_pb2
from runtime.registry import Peer, Registry

REGISTRY = Registry(
    package="rover",
    envelope=envelope_pb2.Datagram,
    oneof="body",
    peers=(Peer(name="board", port_parameter="dst_a_port", port=6000),),
    handlers=(
        GpsHandler(),
        ImuHandler(),
    ),
    fingerprint="f477fd2591ea7b7995c9b188978a74f3eda42063d90e7cb70c61270a75e3e22e",
    retired={},
)
