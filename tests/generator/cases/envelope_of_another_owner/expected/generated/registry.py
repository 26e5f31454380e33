# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The registry: the envelope, the peers, and a handler for every row and every extra topic."""

from __future__ import annotations

from generated.pb2.link import envelope_pb2
from generated.serializers.gps import FastGpsHandler
from generated.serializers.imu import FastImuHandler
from roverlink.runtime.core.registry import Peer, Registry

REGISTRY = Registry(
    package="rover",
    envelope=envelope_pb2.Datagram,
    oneof="body",
    peers=(
        Peer(
            name="board",
            port_parameter="dst_a_port",
            port=6000,
        ),
    ),
    handlers=(
        FastGpsHandler(),
        FastImuHandler(),
    ),
    fingerprint="1395cf0088794b3b978a4c0686e650bc835ec20c4666273bdce17b04e81d9fc3",
    retired={},
)
