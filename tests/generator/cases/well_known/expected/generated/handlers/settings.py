# Generated from mapping.yaml (row settings) and moment.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row settings: Settings and rover/msg/Settings."""

from __future__ import annotations

from google.protobuf import field_mask_pb2

from generated.conversions import any_
from generated.messages import Settings
from generated.pb2 import moment_pb2
from roverlink.runtime.convert.well_known import json_list, json_struct, json_value
from roverlink.runtime.core.handler import Handler, Route


class SettingsHandler(Handler[moment_pb2.Settings, Settings]):
    """Settings as rover/msg/Settings.

    Number 3 of the envelope, ros_to_board, topic settings.
    """

    route = Route(
        number=3,
        name="settings",
        topic="settings",
        direction="ros_to_board",
    )
    payload_type = moment_pb2.Settings
    message_type = Settings

    @staticmethod
    def to_ros(payload: moment_pb2.Settings) -> Settings:
        """Convert Settings to rover/msg/Settings."""
        return Settings(
            config=(
                json_struct.to_ros(payload.config, "config")
                if payload.HasField("config")
                else ""
            ),
            value=(
                json_value.to_ros(payload.value, "value")
                if payload.HasField("value")
                else ""
            ),
            list_field=(
                json_list.to_ros(payload.list, "list_field")
                if payload.HasField("list")
                else ""
            ),
            mask=list(payload.mask.paths),
            extra=any_.to_ros(payload.extra),
            maybe=(
                json_struct.to_ros(payload.maybe, "maybe")
                if payload.HasField("maybe")
                else ""
            ),
            null=payload.null,
        )

    @staticmethod
    def from_ros(message: Settings) -> moment_pb2.Settings:
        """Convert rover/msg/Settings to Settings."""
        return moment_pb2.Settings(
            config=(
                json_struct.from_ros(message.config, "config")
                if message.config
                else None
            ),
            value=(
                json_value.from_ros(message.value, "value") if message.value else None
            ),
            list=(
                json_list.from_ros(message.list_field, "list_field")
                if message.list_field
                else None
            ),
            mask=field_mask_pb2.FieldMask(paths=message.mask),
            extra=any_.from_ros(message.extra),
            maybe=(
                json_struct.from_ros(message.maybe, "maybe") if message.maybe else None
            ),
            null=message.null,
        )
