# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The registry: the envelope, the peers, and a handler for every row and every extra topic."""

from __future__ import annotations

from generated.handlers import ANameThatIsSoLongThatTwoOfThemNeverFitIntoOneLineHandler
from generated.pb2 import envelope_pb2
from generated.serializers.short import FastShortHandler
from roverlink.runtime.core.registry import Peer, Registry

REGISTRY = Registry(
    package="rover",
    envelope=envelope_pb2.Envelope,
    oneof="payload",
    peers=(
        Peer(
            name="a_peer_whose_name_is_long",
            port_parameter="dst_a_port",
            port=6000,
        ),
        Peer(
            name="another_peer_whose_name_is_long",
            port_parameter="dst_b_port",
            port=6001,
        ),
        Peer(
            name="board",
            port_parameter="dst_c_port",
            port=6002,
        ),
        Peer(
            name="yet_another_peer_whose_name_is_long",
            port_parameter="dst_d_port",
            port=6003,
            strip_trailing_zeros=True,
        ),
    ),
    handlers=(
        ANameThatIsSoLongThatTwoOfThemNeverFitIntoOneLineHandler(),
        FastShortHandler(),
    ),
    fingerprint="0427d31785ef4cbb31d5186348c57b3e0522a1de97bd028bb2ff9d844acf7083",
    retired={},
)
