# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Every row's handler, with the envelope they travel in."""

from __future__ import annotations

from generated.handlers import NowHandler
from generated.pb2 import envelope_pb2
from roverlink.runtime.core.registry import Peer, Registry

REGISTRY = Registry(
    package="rover",
    envelope=envelope_pb2.Envelope,
    oneof="payload",
    peers=(Peer(name="board", port_parameter="dst_a_port", port=6000),),
    handlers=(NowHandler(),),
    fingerprint="5085db7a0e7dd685bebad6db9a2fa5a26c01b2c6e241de0ae30ec7e2e8000968",
    retired={
        1: "before",
        7: "never_published",
    },
)
