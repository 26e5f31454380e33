# Generated from mapping.yaml (row command) and command.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row command: Command and rover/msg/Command."""

from __future__ import annotations

from google.protobuf import wrappers_pb2

from generated.conversions import empty, move
from generated.messages import Command
from generated.pb2 import command_pb2
from roverlink.runtime.convert import oneof
from roverlink.runtime.convert.well_known import json_value, timestamp
from roverlink.runtime.core.handler import Handler, Route

WHICH_ACTION_MEMBERS = {
    "move": Command.ACTION_MOVE,
    "stop": Command.ACTION_STOP,
    "gear": Command.ACTION_GEAR,
    "wake_at": Command.ACTION_WAKE_AT,
    "scale": Command.ACTION_SCALE,
    "setting": Command.ACTION_SETTING,
    "raw": Command.ACTION_RAW,
    "lights": Command.ACTION_LIGHTS,
}
WHICH_TARGET_MEMBERS = {
    "name": Command.TARGET_NAME,
}


class CommandHandler(Handler[command_pb2.Command, Command]):
    """Command as rover/msg/Command.

    Number 1 of the envelope, ros_to_board, topic command.
    """

    route = Route(
        number=1,
        name="command",
        topic="command",
        direction="ros_to_board",
    )
    payload_type = command_pb2.Command
    message_type = Command

    @staticmethod
    def to_ros(payload: command_pb2.Command) -> Command:
        """Convert Command to rover/msg/Command."""
        return Command(
            id=payload.id,
            which_action=oneof.number(payload, "action", WHICH_ACTION_MEMBERS),
            move=move.to_ros(payload.move),
            stop=empty.to_ros(payload.stop),
            gear=payload.gear,
            wake_at=timestamp.to_ros(payload.wake_at, "wake_at"),
            scale=payload.scale.value,
            setting=(
                json_value.to_ros(payload.setting, "setting")
                if payload.HasField("setting")
                else ""
            ),
            raw=payload.raw,
            lights=payload.lights,
            which_target=oneof.number(payload, "target", WHICH_TARGET_MEMBERS),
            name=payload.name,
        )

    @staticmethod
    def from_ros(message: Command) -> command_pb2.Command:
        """Convert rover/msg/Command to Command."""
        which_action = oneof.member(
            message.which_action, WHICH_ACTION_MEMBERS, "which_action"
        )
        which_target = oneof.member(
            message.which_target, WHICH_TARGET_MEMBERS, "which_target"
        )
        return command_pb2.Command(
            id=message.id,
            move=move.from_ros(message.move) if which_action == "move" else None,
            stop=empty.from_ros(message.stop) if which_action == "stop" else None,
            gear=message.gear if which_action == "gear" else None,
            wake_at=(
                timestamp.from_ros(message.wake_at, "wake_at")
                if which_action == "wake_at"
                else None
            ),
            scale=(
                wrappers_pb2.FloatValue(value=message.scale)
                if which_action == "scale"
                else None
            ),
            setting=(
                json_value.from_ros(message.setting, "setting")
                if which_action == "setting"
                else None
            ),
            raw=message.raw if which_action == "raw" else None,
            lights=message.lights if which_action == "lights" else None,
            name=message.name if which_target == "name" else None,
        )
