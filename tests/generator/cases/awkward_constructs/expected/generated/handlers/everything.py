# Generated from mapping.yaml (row everything) and any.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row everything: Everything and rover/msg/Everything."""

from __future__ import annotations

from generated.conversions import (
    depth_,
    duration_,
    everything_anything,
    json_struct_,
    key_,
    keywords_,
    mapping_,
    oneof_,
    time,
    value_,
)
from generated.messages import (
    Everything,
    EverythingKeyEntry,
    EverythingMappingEntry,
    EverythingValueEntry,
)
from generated.pb2 import any_pb2
from roverlink.runtime.convert import oneof
from roverlink.runtime.convert.keywords import keywords
from roverlink.runtime.convert.maps import mapping
from roverlink.runtime.convert.well_known import duration, json_struct, timestamp
from roverlink.runtime.core.handler import Handler, Route

WHICH_KIND_MEMBERS = {
    "depth": Everything.KIND_DEPTH,
    "json_struct": Everything.KIND_JSON_STRUCT,
    "struct": Everything.KIND_STRUCT,
}


class EverythingHandler(Handler[any_pb2.Everything, Everything]):
    """Everything as rover/msg/Everything.

    Number 1 of the envelope, board_to_ros, topic everything.
    """

    route = Route(
        number=1,
        name="everything",
        topic="everything",
        direction="board_to_ros",
    )
    payload_type = any_pb2.Everything
    message_type = Everything

    @staticmethod
    def to_ros(payload: any_pb2.Everything) -> Everything:
        """Convert Everything to rover/msg/Everything."""
        return Everything(
            key=[
                EverythingKeyEntry(key=key, value=key_.to_ros(value))
                for key, value in sorted(payload.key.items())
            ],
            value=[
                EverythingValueEntry(key=key, value=value_.to_ros(value))
                for key, value in sorted(payload.value.items())
            ],
            mapping=[
                EverythingMappingEntry(key=key, value=mapping_.to_ros(value))
                for key, value in sorted(payload.mapping.items())
            ],
            when=payload.timestamp.when,
            time=time.to_ros(payload.time),
            stamp=timestamp.to_ros(payload.stamp, "stamp"),
            duration=duration.to_ros(payload.duration, "duration"),
            oneof=oneof_.to_ros(payload.oneof_),
            which_kind=oneof.number(payload, "kind", WHICH_KIND_MEMBERS),
            depth=depth_.to_ros(payload.depth),
            json_struct=json_struct_.to_ros(payload.json_struct),
            struct_field=(
                json_struct.to_ros(payload.struct, "struct_field")
                if payload.HasField("struct")
                else ""
            ),
            anything=everything_anything.to_ros(payload.anything),
            keywords=keywords_.to_ros(payload.keywords),
            other=duration_.to_ros(payload.other),
            class_field=getattr(payload, "class"),
        )

    @staticmethod
    def from_ros(message: Everything) -> any_pb2.Everything:
        """Convert rover/msg/Everything to Everything."""
        which_kind = oneof.member(message.which_kind, WHICH_KIND_MEMBERS, "which_kind")
        return any_pb2.Everything(
            key=mapping(
                ((item.key, key_.from_ros(item.value)) for item in message.key), "key"
            ),
            value=mapping(
                ((item.key, value_.from_ros(item.value)) for item in message.value),
                "value",
            ),
            mapping=mapping(
                ((item.key, mapping_.from_ros(item.value)) for item in message.mapping),
                "mapping",
            ),
            timestamp={"when": message.when},
            time=time.from_ros(message.time),
            stamp=timestamp.from_ros(message.stamp, "stamp"),
            duration=duration.from_ros(message.duration, "duration"),
            oneof_=oneof_.from_ros(message.oneof),
            depth=depth_.from_ros(message.depth) if which_kind == "depth" else None,
            json_struct=(
                json_struct_.from_ros(message.json_struct)
                if which_kind == "json_struct"
                else None
            ),
            struct=(
                json_struct.from_ros(message.struct_field, "struct_field")
                if which_kind == "struct"
                else None
            ),
            anything=everything_anything.from_ros(message.anything),
            keywords=keywords_.from_ros(message.keywords),
            other=duration_.from_ros(message.other),
            **keywords(
                {
                    "class": message.class_field,
                }
            ),
        )
