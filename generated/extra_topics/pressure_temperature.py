# Generated from mapping.yaml (row pressure_info) and components/sensor_board/pressure_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the topic pressure/temperature: SensorBoardPressureInfo and sensor_msgs/msg/Temperature."""

from __future__ import annotations

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2.components.sensor_board import pressure_sensor_pb2
from roverlink.runtime.core.handler import Route
from roverlink.runtime.core.standard_handler import UNSTAMPED, StandardHandler, single
from roverlink.runtime.interfaces import Time


class PressureTemperatureTopic(
    StandardHandler[
        pressure_sensor_pb2.SensorBoardPressureInfo, sensor_msgs.Temperature
    ]
):
    """One reading of a pressure sensor.

    Extra topic of the row pressure_info, number 15 of the envelope, from the peer
    hardware to the topic pressure/temperature.
    """

    route = Route(
        number=15,
        name="pressure_info",
        topic="pressure/temperature",
        direction="hardware_to_ros",
        board="SensorBoard",
    )
    payload_type = pressure_sensor_pb2.SensorBoardPressureInfo
    message_type = sensor_msgs.Temperature

    @staticmethod
    def to_ros(
        payload: pressure_sensor_pb2.SensorBoardPressureInfo,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.Temperature:
        """Convert SensorBoardPressureInfo to sensor_msgs/msg/Temperature; `stamp` is the time of reception."""
        return sensor_msgs.Temperature(
            header=std_msgs.Header(stamp=stamp, frame_id="pressure_link"),
            temperature=payload.temperature_c,
        )

    @staticmethod
    def from_ros(
        message: sensor_msgs.Temperature,
    ) -> pressure_sensor_pb2.SensorBoardPressureInfo:
        """Convert sensor_msgs/msg/Temperature to SensorBoardPressureInfo.

        Fields of the payload that the message does not contain keep their defaults:
        sensor_index, pressure_kpa, voltage, is_calibrated, state, error_code.
        """
        return pressure_sensor_pb2.SensorBoardPressureInfo(
            temperature_c=single(message.temperature),
        )
