# Generated from mapping.yaml (row lists) and moment.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row lists: Lists and rover/msg/Lists."""

from __future__ import annotations

from google.protobuf import wrappers_pb2

from generated.conversions import any_, empty, field_mask
from generated.messages import Bytes, Lists
from generated.pb2 import moment_pb2
from roverlink.runtime.convert.well_known import (
    duration,
    json_list,
    json_struct,
    json_value,
    timestamp,
)
from roverlink.runtime.core.handler import Handler, Route


class ListsHandler(Handler[moment_pb2.Lists, Lists]):
    """Lists as rover/msg/Lists.

    Number 2 of the envelope, ros_to_board, topic lists.
    """

    route = Route(
        number=2,
        name="lists",
        topic="lists",
        direction="ros_to_board",
    )
    payload_type = moment_pb2.Lists
    message_type = Lists

    @staticmethod
    def to_ros(payload: moment_pb2.Lists) -> Lists:
        """Convert Lists to rover/msg/Lists."""
        return Lists(
            stamps=[timestamp.to_ros(item, "stamps") for item in payload.stamps],
            durations=[
                duration.to_ros(item, "durations") for item in payload.durations
            ],
            masks=[field_mask.to_ros(item) for item in payload.masks],
            nothings=[empty.to_ros(item) for item in payload.nothings],
            anys=[any_.to_ros(item) for item in payload.anys],
            structs=[json_struct.to_ros(item, "structs") for item in payload.structs],
            values=[json_value.to_ros(item, "values") for item in payload.values],
            lists=[json_list.to_ros(item, "lists") for item in payload.lists],
            floats=[item.value for item in payload.floats],
            blobs=[Bytes(data=item.value) for item in payload.blobs],
            parts=[Bytes(data=item) for item in payload.parts],
        )

    @staticmethod
    def from_ros(message: Lists) -> moment_pb2.Lists:
        """Convert rover/msg/Lists to Lists."""
        return moment_pb2.Lists(
            stamps=[timestamp.from_ros(item, "stamps") for item in message.stamps],
            durations=[
                duration.from_ros(item, "durations") for item in message.durations
            ],
            masks=[field_mask.from_ros(item) for item in message.masks],
            nothings=[empty.from_ros(item) for item in message.nothings],
            anys=[any_.from_ros(item) for item in message.anys],
            structs=[json_struct.from_ros(item, "structs") for item in message.structs],
            values=[json_value.from_ros(item, "values") for item in message.values],
            lists=[json_list.from_ros(item, "lists") for item in message.lists],
            floats=[wrappers_pb2.FloatValue(value=item) for item in message.floats],
            blobs=[wrappers_pb2.BytesValue(value=item.data) for item in message.blobs],
            parts=[item.data for item in message.parts],
        )
