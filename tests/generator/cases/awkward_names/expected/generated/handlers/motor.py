# Generated from mapping.yaml (row motor) and awkward.proto; do not edit.
# Regenerate with: roverlink generate
"""motor (8): MotorHandler to rover/msg/MotorHandler on motor."""

from __future__ import annotations

from generated.handlers.sensor_10 import Sensor10Handler
from generated.messages import MotorHandler_
from generated.pb2 import awkward_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(MotorHandler_)


class MotorHandler(Handler[awkward_pb2.MotorHandler, MotorHandler_]):
    """MotorHandler to the topic motor."""

    route = Route(number=8, name="motor", topic="motor", direction="board_to_ros")
    payload_type = awkward_pb2.MotorHandler
    message_type = MotorHandler_

    @staticmethod
    def to_ros(payload: awkward_pb2.MotorHandler) -> MotorHandler_:
        """The message that says what the payload says."""
        return MotorHandler_(ten=Sensor10Handler.to_ros(payload.ten))

    @staticmethod
    def from_ros(message: MotorHandler_) -> awkward_pb2.MotorHandler:
        """The payload that says what the message says."""
        return awkward_pb2.MotorHandler(ten=Sensor10Handler.from_ros(message.ten))

    def pack(self, payload: awkward_pb2.MotorHandler) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        ten = payload.ten
        return _CDR.pack(cdr.LITTLE_ENDIAN, ten.x)
