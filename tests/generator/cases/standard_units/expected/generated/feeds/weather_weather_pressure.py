# Generated from mapping.yaml (row weather) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""weather (1): Weather to sensor_msgs/msg/FluidPressure on weather/pressure."""

from __future__ import annotations

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(
    sensor_msgs.FluidPressure(header=std_msgs.Header(frame_id="mast"), variance=25.0),
    ["header.stamp", "fluid_pressure"],
)
_UP_TO_HEADER_STAMP_SEC, _UP_TO_FLUID_PRESSURE, _REST = _CDR.constants
_PACK = _CDR.layout.pack


class WeatherWeatherPressureFeed(Feed[board_pb2.Weather, sensor_msgs.FluidPressure]):
    """Weather to sensor_msgs/FluidPressure on the topic weather/pressure."""

    route = Route(
        number=1,
        name="weather",
        topic="weather/pressure",
        direction="board_to_ros",
    )
    payload_type = board_pb2.Weather
    message_type = sensor_msgs.FluidPressure

    @staticmethod
    def to_ros(
        payload: board_pb2.Weather,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.FluidPressure:
        """The message that says what the payload says."""
        return sensor_msgs.FluidPressure(
            header=std_msgs.Header(stamp=stamp, frame_id="mast"),
            fluid_pressure=payload.pressure_x10 * 10,
            variance=25.0,
        )

    @staticmethod
    def from_ros(message: sensor_msgs.FluidPressure) -> board_pb2.Weather:
        """The payload that says what the message says.

        It says nothing of fahrenheit, humidity, light, acceleration.x, acceleration.y,
        acceleration.z, spin.
        """
        return board_pb2.Weather(pressure_x10=round(message.fluid_pressure / 10.0))

    def pack(self, payload: board_pb2.Weather, stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(
            _UP_TO_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _UP_TO_FLUID_PRESSURE,
            payload.pressure_x10 * 10,
            _REST,
        )
