# Generated from mapping.yaml (row fix) and fix.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row fix: Fix and rover/msg/Fix."""

from __future__ import annotations

from generated.conversions import position
from generated.messages import Fix, Quality
from generated.pb2 import fix_pb2
from roverlink.runtime.core.handler import Handler, Route


class FixHandler(Handler[fix_pb2.Fix, Fix]):
    """Fix as rover/msg/Fix.

    Number 1 of the envelope, board_to_ros, topic fix.
    """

    route = Route(
        number=1,
        name="fix",
        topic="fix",
        direction="board_to_ros",
    )
    payload_type = fix_pb2.Fix
    message_type = Fix

    @staticmethod
    def to_ros(payload: fix_pb2.Fix) -> Fix:
        """Convert Fix to rover/msg/Fix."""
        return Fix(
            has_altitude=payload.HasField("altitude"),
            altitude=payload.altitude,
            has_quality=payload.HasField("quality"),
            quality=Quality(quality=payload.quality),
            has_source=payload.HasField("source"),
            source=payload.source,
            has_position=payload.HasField("position"),
            position=position.to_ros(payload.position),
            speed=payload.speed,
            base=position.to_ros(payload.base),
        )

    @staticmethod
    def from_ros(message: Fix) -> fix_pb2.Fix:
        """Convert rover/msg/Fix to Fix."""
        return fix_pb2.Fix(
            altitude=message.altitude if message.has_altitude else None,
            quality=message.quality.quality if message.has_quality else None,
            source=message.source if message.has_source else None,
            position=(
                position.from_ros(message.position) if message.has_position else None
            ),
            speed=message.speed,
            base=position.from_ros(message.base),
        )
