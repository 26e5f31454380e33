# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The registry: the envelope, the peers, and a handler for every row and every extra topic."""

from __future__ import annotations

from generated.pb2 import envelope_pb2
from generated.serializers.forwarded import FastForwardedHandler
from generated.serializers.hoarding import FastHoardingHandler
from generated.serializers.latched import FastLatchedHandler
from generated.serializers.lossy import FastLossyHandler
from generated.serializers.plain import FastPlainHandler
from generated.serializers.queued import FastQueuedHandler
from generated.serializers.spread import FastSpreadHandler
from generated.serializers.usual import FastUsualHandler
from roverlink.runtime.core.registry import Peer, Registry

REGISTRY = Registry(
    package="rover",
    envelope=envelope_pb2.Envelope,
    oneof="payload",
    peers=(
        Peer(
            name="arm",
            port_parameter="dst_a_port",
            port=7000,
            strip_trailing_zeros=True,
        ),
        Peer(
            name="base",
            port_parameter="base_port",
            port=6001,
        ),
        Peer(
            name="extra",
            port_parameter="dst_c_port",
            port=6002,
        ),
        Peer(
            name="zeta",
            port_parameter="dst_d_port",
            port=6003,
        ),
    ),
    handlers=(
        FastPlainHandler(),
        FastQueuedHandler(),
        FastLossyHandler(),
        FastLatchedHandler(),
        FastHoardingHandler(),
        FastUsualHandler(),
        FastForwardedHandler(),
        FastSpreadHandler(),
    ),
    fingerprint="c32eb868c43f17de2ea637437c6434f05a210a8935ffc2b2266dfa656d66f7a2",
    retired={},
)
