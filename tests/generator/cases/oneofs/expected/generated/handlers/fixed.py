# Generated from mapping.yaml (row fixed) and command.proto; do not edit.
# Regenerate with: roverlink generate
"""fixed (4): Fixed to rover/msg/Fixed on fixed."""

from __future__ import annotations

from generated.messages import Fixed
from generated.pb2 import command_pb2
from roverlink.runtime.convert import oneof
from roverlink.runtime.convert.well_known import timestamp
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(Fixed)
_WHICH_CHOICE = {"a": Fixed.CHOICE_A, "b": Fixed.CHOICE_B}


class FixedHandler(Handler[command_pb2.Fixed, Fixed]):
    """Fixed to the topic fixed."""

    route = Route(number=4, name="fixed", topic="fixed", direction="board_to_ros")
    payload_type = command_pb2.Fixed
    message_type = Fixed

    @staticmethod
    def to_ros(payload: command_pb2.Fixed) -> Fixed:
        """The message that says what the payload says."""
        return Fixed(
            which_choice=oneof.number(payload, "choice", _WHICH_CHOICE),
            a=payload.a,
            b=payload.b,
            stamp=timestamp.to_ros(payload.stamp, "stamp"),
            has_maybe=payload.HasField("maybe"),
            maybe=timestamp.to_ros(payload.maybe, "maybe"),
        )

    @staticmethod
    def from_ros(message: Fixed) -> command_pb2.Fixed:
        """The payload that says what the message says."""
        which_choice = oneof.member(message.which_choice, _WHICH_CHOICE, "which_choice")
        return command_pb2.Fixed(
            a=message.a if which_choice == "a" else None,
            b=message.b if which_choice == "b" else None,
            stamp=timestamp.from_ros(message.stamp, "stamp"),
            maybe=(
                timestamp.from_ros(message.maybe, "maybe")
                if message.has_maybe
                else None
            ),
        )

    def pack(self, payload: command_pb2.Fixed) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(
            cdr.LITTLE_ENDIAN,
            oneof.number(payload, "choice", _WHICH_CHOICE),
            payload.a,
            payload.b,
            *timestamp.parts(payload.stamp, "stamp"),
            payload.HasField("maybe"),
            *timestamp.parts(payload.maybe, "maybe"),
        )
