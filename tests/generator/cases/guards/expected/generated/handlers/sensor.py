# Generated from mapping.yaml (row sensor) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""sensor (4): Sensor to rover/msg/Sensor on sensor."""

from __future__ import annotations

from generated.messages import Sensor
from generated.pb2 import all_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(Sensor)


class SensorHandler(Handler[all_pb2.Sensor, Sensor]):
    """Sensor to the topic sensor."""

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
        """The message that says what the payload says."""
        return Sensor(value=payload.value)

    @staticmethod
    def from_ros(message: Sensor) -> all_pb2.Sensor:
        """The payload that says what the message says."""
        return all_pb2.Sensor(value=message.value)

    def pack(self, payload: all_pb2.Sensor) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.value)
