# Generated from mapping.yaml (row fix) and fix.proto; do not edit.
# Regenerate with: roverlink generate
"""fix (1): Fix to rover/msg/Fix on fix."""

from __future__ import annotations

from generated.conversions import position
from generated.messages import Fix, Quality
from generated.pb2 import fix_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(Fix)


class FixHandler(Handler[fix_pb2.Fix, Fix]):
    """Fix to the topic fix."""

    route = Route(number=1, name="fix", topic="fix", direction="board_to_ros")
    payload_type = fix_pb2.Fix
    message_type = Fix

    @staticmethod
    def to_ros(payload: fix_pb2.Fix) -> Fix:
        """The message that says what the payload says."""
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
        """The payload that says what the message says."""
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

    def pack(self, payload: fix_pb2.Fix) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        position = payload.position
        base = payload.base
        return _CDR.pack(
            cdr.LITTLE_ENDIAN,
            payload.HasField("altitude"),
            payload.altitude,
            payload.HasField("quality"),
            payload.quality,
            payload.HasField("source"),
            payload.source,
            payload.HasField("position"),
            position.x,
            position.HasField("y"),
            position.y,
            payload.speed,
            base.x,
            base.HasField("y"),
            base.y,
        )
