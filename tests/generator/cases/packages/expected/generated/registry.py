# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The registry: the envelope, the peers, and a handler for every row and every extra topic."""

from __future__ import annotations

from generated.handlers import DriveStateHandler
from generated.pb2.rover.link import envelope_pb2
from generated.serializers.arm_state import FastArmStateHandler
from generated.serializers.inner import FastInnerHandler
from generated.serializers.top import FastTopHandler
from roverlink.runtime.core.registry import Peer, Registry

REGISTRY = Registry(
    package="rover",
    envelope=envelope_pb2.Envelope,
    oneof="body",
    peers=(
        Peer(
            name="board",
            port_parameter="dst_a_port",
            port=6000,
        ),
    ),
    handlers=(
        FastArmStateHandler(),
        DriveStateHandler(),
        FastTopHandler(),
        FastInnerHandler(),
    ),
    fingerprint="7e9ff931109066f97af5280b2db366f455bf645d94638270d72fdcb6287c67ed",
    retired={},
)
