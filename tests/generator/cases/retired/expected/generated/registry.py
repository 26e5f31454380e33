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
    fingerprint="f3c894edf1b8d27e4d66b3cffbba026d003f59308cc88bc86bf0f696f31bd878",
    retired={
        1: "before",
        7: "never_published",
    },
)
