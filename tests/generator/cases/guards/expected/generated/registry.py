# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The registry: the envelope, the peers, and a handler for every row and every extra topic."""

from __future__ import annotations

from generated.handlers import ArmHandler, IdleHandler
from generated.pb2 import envelope_pb2
from generated.serializers.drive import FastDriveHandler
from generated.serializers.sensor import FastSensorHandler
from roverlink.runtime.core.registry import Peer, Registry

REGISTRY = Registry(
    package="rover",
    envelope=envelope_pb2.Envelope,
    oneof="payload",
    peers=(
        Peer(
            name="base",
            port_parameter="dst_a_port",
            port=6000,
            sources=("192.168.1.2",),
        ),
        Peer(
            name="board",
            port_parameter="dst_b_port",
            port=6001,
            sources=("10.0.0.7", "10.0.1.0/24"),
            source_rate=2000,
        ),
        Peer(
            name="other",
            port_parameter="dst_c_port",
            port=6002,
        ),
    ),
    handlers=(
        FastDriveHandler(),
        ArmHandler(),
        IdleHandler(),
        FastSensorHandler(),
    ),
    fingerprint="50ed3662de6020bfdcb9c872829c343ca7b4f14ad0a86a06211a8d477fa2225c",
    retired={},
)
