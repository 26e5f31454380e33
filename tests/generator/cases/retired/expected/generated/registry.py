# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Every row's handler, with the envelope they travel in."""

from __future__ import annotations

from generated.handlers import NowHandler
from generated.pb2 import envelope_pb2
from runtime.registry import Peer, Registry

REGISTRY = Registry(
    package="rover",
    envelope=envelope_pb2.Envelope,
    oneof="payload",
    peers=(Peer(name="board", port_parameter="dst_a_port", port=6000),),
    handlers=(NowHandler(),),
    fingerprint="8b7f27f545b479b359752a33b81f08f85a28bc4d934a9019f283c92812d9f3a8",
    retired={
        1: "before",
        7: "never_published",
    },
)
