# Generated from mapping.yaml (row velocity) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""velocity (4): Velocity to rover/msg/Velocity on velocity."""

from __future__ import annotations

from generated.messages import Velocity
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(Velocity)


class VelocityHandler(Handler[board_pb2.Velocity, Velocity]):
    """Velocity to the topic velocity."""

    route = Route(number=4, name="velocity", topic="velocity", direction="board_to_ros")
    payload_type = board_pb2.Velocity
    message_type = Velocity

    @staticmethod
    def to_ros(payload: board_pb2.Velocity) -> Velocity:
        """The message that says what the payload says."""
        return Velocity(
            forward=payload.forward,
            turn=payload.turn,
            sequence=payload.sequence,
        )

    @staticmethod
    def from_ros(message: Velocity) -> board_pb2.Velocity:
        """The payload that says what the message says."""
        return board_pb2.Velocity(
            forward=message.forward,
            turn=message.turn,
            sequence=message.sequence,
        )

    def pack(self, payload: board_pb2.Velocity) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(
            cdr.LITTLE_ENDIAN,
            payload.forward,
            payload.turn,
            payload.sequence,
        )
