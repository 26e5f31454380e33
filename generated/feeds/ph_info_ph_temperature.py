# Generated from mapping.yaml (row ph_info) and components/sensor_board/ph_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""ph_info (1): SensorBoardPHInfo to sensor_msgs/msg/Temperature on ph/temperature."""

from __future__ import annotations

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2.components.sensor_board import ph_sensor_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed, single
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(
    sensor_msgs.Temperature(header=std_msgs.Header(frame_id="ph_link")),
    ["header.stamp", "temperature"],
)
_UP_TO_HEADER_STAMP_SEC, _UP_TO_TEMPERATURE, _REST = _CDR.constants
_PACK = _CDR.layout.pack


class PhInfoPhTemperatureFeed(
    Feed[ph_sensor_pb2.SensorBoardPHInfo, sensor_msgs.Temperature],
):
    """SensorBoardPHInfo to sensor_msgs/Temperature on the topic ph/temperature."""

    route = Route(
        number=1,
        name="ph_info",
        topic="ph/temperature",
        direction="hardware_to_ros",
    )
    payload_type = ph_sensor_pb2.SensorBoardPHInfo
    message_type = sensor_msgs.Temperature

    @staticmethod
    def to_ros(
        payload: ph_sensor_pb2.SensorBoardPHInfo,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.Temperature:
        """The message that says what the payload says."""
        return sensor_msgs.Temperature(
            header=std_msgs.Header(stamp=stamp, frame_id="ph_link"),
            temperature=payload.temperature,
        )

    @staticmethod
    def from_ros(message: sensor_msgs.Temperature) -> ph_sensor_pb2.SensorBoardPHInfo:
        """The payload that says what the message says.

        It says nothing of ph_value, voltage, state, error_code.
        """
        return ph_sensor_pb2.SensorBoardPHInfo(temperature=single(message.temperature))

    def pack(
        self,
        payload: ph_sensor_pb2.SensorBoardPHInfo,
        stamp: Time = UNSTAMPED,
    ) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(
            _UP_TO_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _UP_TO_TEMPERATURE,
            payload.temperature,
            _REST,
        )
