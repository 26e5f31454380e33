# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The registry: the envelope, the peers, and a handler for every row and every extra topic."""

from __future__ import annotations

from generated.pb2 import envelope_pb2
from generated.serializers.now import FastNowHandler
from roverlink.runtime.core.registry import Peer, Registry

REGISTRY = Registry(
    package="rover",
    envelope=envelope_pb2.Envelope,
    oneof="payload",
    peers=(
        Peer(
            name="board",
            port_parameter="dst_a_port",
            port=6000,
        ),
    ),
    handlers=(FastNowHandler(),),
    fingerprint="5085db7a0e7dd685bebad6db9a2fa5a26c01b2c6e241de0ae30ec7e2e8000968",
    retired={
        1: "before",
        7: "never_published",
    },
)
