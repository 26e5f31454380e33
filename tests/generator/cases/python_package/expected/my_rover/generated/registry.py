# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Every row's handler, with the envelope they travel in."""

from __future__ import annotations

from my_rover.generated.feeds import NoteHeightFeed
from my_rover.generated.handlers import NoteHandler
from my_rover.generated.pb2 import envelope_pb2
from roverlink.runtime.core.registry import Peer, Registry

REGISTRY = Registry(
    package="rover",
    envelope=envelope_pb2.Envelope,
    oneof="payload",
    peers=(Peer(name="board", port_parameter="dst_a_port", port=6000),),
    handlers=(NoteHandler(),),
    feeds=(NoteHeightFeed(),),
    fingerprint="eebc7880c0e20aded57534b164568e390bb3f0fa4fd599448cea7e34961b6e1f",
    retired={},
)
