# Generated from mapping.yaml (row pressure_info) and components/sensor_board/pressure_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""pressure_info (15): SensorBoardPressureInfo to sensor_msgs/msg/Temperature on pressure/temperature."""

from __future__ import annotations

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2.components.sensor_board import pressure_sensor_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed, single
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(
    sensor_msgs.Temperature(header=std_msgs.Header(frame_id="pressure_link")),
    ["header.stamp", "temperature"],
)
_UP_TO_HEADER_STAMP_SEC, _UP_TO_TEMPERATURE, _REST = _CDR.constants
_PACK = _CDR.layout.pack


class PressureInfoPressureTemperatureFeed(
    Feed[pressure_sensor_pb2.SensorBoardPressureInfo, sensor_msgs.Temperature],
):
    """SensorBoardPressureInfo to sensor_msgs/Temperature on the topic pressure/temperature."""

    route = Route(
        number=15,
        name="pressure_info",
        topic="pressure/temperature",
        direction="hardware_to_ros",
    )
    payload_type = pressure_sensor_pb2.SensorBoardPressureInfo
    message_type = sensor_msgs.Temperature

    @staticmethod
    def to_ros(
        payload: pressure_sensor_pb2.SensorBoardPressureInfo,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.Temperature:
        """The message that says what the payload says."""
        return sensor_msgs.Temperature(
            header=std_msgs.Header(stamp=stamp, frame_id="pressure_link"),
            temperature=payload.temperature_c,
        )

    @staticmethod
    def from_ros(
        message: sensor_msgs.Temperature,
    ) -> pressure_sensor_pb2.SensorBoardPressureInfo:
        """The payload that says what the message says.

        It says nothing of sensor_index, pressure_kpa, voltage, is_calibrated, state,
        error_code.
        """
        return pressure_sensor_pb2.SensorBoardPressureInfo(
            temperature_c=single(message.temperature),
        )

    def pack(
        self,
        payload: pressure_sensor_pb2.SensorBoardPressureInfo,
        stamp: Time = UNSTAMPED,
    ) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(
            _UP_TO_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _UP_TO_TEMPERATURE,
            payload.temperature_c,
            _REST,
        )
