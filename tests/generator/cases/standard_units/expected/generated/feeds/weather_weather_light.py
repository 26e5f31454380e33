# Generated from mapping.yaml (row weather) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""weather (1): Weather to sensor_msgs/msg/Illuminance on weather/light."""

from __future__ import annotations

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(
    sensor_msgs.Illuminance(header=std_msgs.Header(frame_id="mast")),
    ["header.stamp", "illuminance"],
)
_UP_TO_HEADER_STAMP_SEC, _UP_TO_ILLUMINANCE, _REST = _CDR.constants
_PACK = _CDR.layout.pack


class WeatherWeatherLightFeed(Feed[board_pb2.Weather, sensor_msgs.Illuminance]):
    """Weather to sensor_msgs/Illuminance on the topic weather/light."""

    route = Route(
        number=1,
        name="weather",
        topic="weather/light",
        direction="board_to_ros",
    )
    payload_type = board_pb2.Weather
    message_type = sensor_msgs.Illuminance

    @staticmethod
    def to_ros(
        payload: board_pb2.Weather,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.Illuminance:
        """The message that says what the payload says."""
        return sensor_msgs.Illuminance(
            header=std_msgs.Header(stamp=stamp, frame_id="mast"),
            illuminance=payload.light / 4.0 - 2.0,
        )

    @staticmethod
    def from_ros(message: sensor_msgs.Illuminance) -> board_pb2.Weather:
        """The payload that says what the message says.

        It says nothing of pressure_x10, fahrenheit, humidity, acceleration.x,
        acceleration.y, acceleration.z, spin.
        """
        return board_pb2.Weather(light=round((message.illuminance + 2.0) * 4.0))

    def pack(self, payload: board_pb2.Weather, stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(
            _UP_TO_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _UP_TO_ILLUMINANCE,
            payload.light / 4.0 - 2.0,
            _REST,
        )
