# Generated from mapping.yaml (row fix) and fix.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row fix: Fix and rover/msg/Fix."""

from __future__ import annotations

from google.protobuf import wrappers_pb2

from generated.conversions import position
from generated.messages import Fix, FixByNameEntry
from generated.pb2 import fix_pb2
from roverlink.runtime.convert.maps import mapping
from roverlink.runtime.convert.well_known import duration, timestamp
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
            altitude=payload.altitude,
            has_speed=payload.HasField("speed"),
            speed=payload.speed,
            has_base=payload.HasField("base"),
            base=position.to_ros(payload.base),
            has_stamp=payload.HasField("stamp"),
            stamp=timestamp.to_ros(payload.stamp, "stamp"),
            took=duration.to_ros(payload.took, "took"),
            apart_x=payload.apart.x,
            apart_y=payload.apart.y,
            has_apart_stamp=payload.apart.HasField("stamp"),
            apart_stamp=timestamp.to_ros(payload.apart.stamp, "apart_stamp"),
            scale=payload.scale.value,
            positions=[position.to_ros(item) for item in payload.positions],
            by_name=[
                FixByNameEntry(key=key, value=position.to_ros(value))
                for key, value in sorted(payload.by_name.items())
            ],
        )

    @staticmethod
    def from_ros(message: Fix) -> fix_pb2.Fix:
        """Convert rover/msg/Fix to Fix."""
        return fix_pb2.Fix(
            altitude=message.altitude,
            speed=message.speed if message.has_speed else None,
            base=position.from_ros(message.base) if message.has_base else None,
            stamp=(
                timestamp.from_ros(message.stamp, "stamp")
                if message.has_stamp
                else None
            ),
            took=duration.from_ros(message.took, "took"),
            apart={
                "x": message.apart_x,
                "y": message.apart_y,
                "stamp": (
                    timestamp.from_ros(message.apart_stamp, "apart_stamp")
                    if message.has_apart_stamp
                    else None
                ),
            },
            scale=wrappers_pb2.FloatValue(value=message.scale),
            positions=[position.from_ros(item) for item in message.positions],
            by_name=mapping(
                ((item.key, position.from_ros(item.value)) for item in message.by_name),
                "by_name",
            ),
        )
