# Generated from mapping.yaml (row motor) and awkward.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row motor: MotorHandler and rover/msg/MotorHandler."""

from __future__ import annotations

from generated.handlers.sensor_10 import Sensor10Handler
from generated.messages import MotorHandler_
from generated.pb2 import awkward_pb2
from roverlink.runtime.core.handler import Handler, Route


class MotorHandler(Handler[awkward_pb2.MotorHandler, MotorHandler_]):
    """MotorHandler as rover/msg/MotorHandler.

    Number 8 of the envelope, board_to_ros, topic motor.
    """

    route = Route(
        number=8,
        name="motor",
        topic="motor",
        direction="board_to_ros",
    )
    payload_type = awkward_pb2.MotorHandler
    message_type = MotorHandler_

    @staticmethod
    def to_ros(payload: awkward_pb2.MotorHandler) -> MotorHandler_:
        """Convert MotorHandler to rover/msg/MotorHandler."""
        return MotorHandler_(
            ten=Sensor10Handler.to_ros(payload.ten),
        )

    @staticmethod
    def from_ros(message: MotorHandler_) -> awkward_pb2.MotorHandler:
        """Convert rover/msg/MotorHandler to MotorHandler."""
        return awkward_pb2.MotorHandler(
            ten=Sensor10Handler.from_ros(message.ten),
        )
