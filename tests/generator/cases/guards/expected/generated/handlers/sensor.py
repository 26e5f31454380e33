# Generated from mapping.yaml (row sensor) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row sensor: Sensor and rover/msg/Sensor."""

from __future__ import annotations

from generated.messages import Sensor
from generated.pb2 import all_pb2
from roverlink.runtime.core.handler import Handler, Route


class SensorHandler(Handler[all_pb2.Sensor, Sensor]):
    """Sensor as rover/msg/Sensor.

    Number 4 of the envelope, board_to_ros, topic sensor.
    """

    route = Route(
        number=4,
        name="sensor",
        topic="sensor",
        direction="board_to_ros",
        max_rate=10,
    )
    payload_type = all_pb2.Sensor
    message_type = Sensor

    @staticmethod
    def to_ros(payload: all_pb2.Sensor) -> Sensor:
        """Convert Sensor to rover/msg/Sensor."""
        return Sensor(
            value=payload.value,
        )

    @staticmethod
    def from_ros(message: Sensor) -> all_pb2.Sensor:
        """Convert rover/msg/Sensor to Sensor."""
        return all_pb2.Sensor(
            value=message.value,
        )
