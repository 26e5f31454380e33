# Generated from mapping.yaml and packet.proto; do not edit.
# Regenerate with: roverlink generate
"""Convert between the nested messages Inner and rover/msg/Inner."""

from __future__ import annotations

from generated.conversions import inner_detail
from generated.messages import Inner
from generated.pb2 import packet_pb2
from roverlink.runtime.convert.well_known import timestamp


def to_ros(payload: packet_pb2.Inner) -> Inner:
    """Convert Inner to rover/msg/Inner."""
    return Inner(
        detail=inner_detail.to_ros(payload.detail),
        has_stamp=payload.HasField("stamp"),
        stamp=timestamp.to_ros(payload.stamp, "Inner.stamp"),
    )


def from_ros(message: Inner) -> packet_pb2.Inner:
    """Convert rover/msg/Inner to Inner."""
    return packet_pb2.Inner(
        detail=inner_detail.from_ros(message.detail),
        stamp=(
            timestamp.from_ros(message.stamp, "Inner.stamp")
            if message.has_stamp
            else None
        ),
    )
