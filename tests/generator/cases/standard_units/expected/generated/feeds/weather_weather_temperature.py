# Generated from mapping.yaml (row weather) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""weather (1): Weather to sensor_msgs/msg/Temperature on weather/temperature."""

from __future__ import annotations

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed, single
from roverlink.runtime.core.handler import Qos, Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(
    sensor_msgs.Temperature(header=std_msgs.Header(frame_id="mast")),
    ["header.stamp", "temperature"],
)
_UP_TO_HEADER_STAMP_SEC, _UP_TO_TEMPERATURE, _REST = _CDR.constants
_PACK = _CDR.layout.pack


class WeatherWeatherTemperatureFeed(Feed[board_pb2.Weather, sensor_msgs.Temperature]):
    """Weather to sensor_msgs/Temperature on the topic weather/temperature."""

    route = Route(
        number=1,
        name="weather",
        topic="weather/temperature",
        direction="board_to_ros",
        qos=Qos(reliability="best_effort", depth=3),
    )
    payload_type = board_pb2.Weather
    message_type = sensor_msgs.Temperature

    @staticmethod
    def to_ros(
        payload: board_pb2.Weather,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.Temperature:
        """The message that says what the payload says."""
        return sensor_msgs.Temperature(
            header=std_msgs.Header(stamp=stamp, frame_id="mast"),
            temperature=(payload.fahrenheit - 32.0) / 1.8,
        )

    @staticmethod
    def from_ros(message: sensor_msgs.Temperature) -> board_pb2.Weather:
        """The payload that says what the message says.

        It says nothing of pressure_x10, humidity, light, acceleration.x,
        acceleration.y, acceleration.z, spin.
        """
        return board_pb2.Weather(fahrenheit=single(message.temperature * 1.8 + 32.0))

    def pack(self, payload: board_pb2.Weather, stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(
            _UP_TO_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _UP_TO_TEMPERATURE,
            (payload.fahrenheit - 32.0) / 1.8,
            _REST,
        )
