# Generated from mapping.yaml (row ph_info) and components/sensor_board/ph_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the topic ph/temperature: SensorBoardPHInfo and sensor_msgs/msg/Temperature."""

from __future__ import annotations

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2.components.sensor_board import ph_sensor_pb2
from roverlink.runtime.core.handler import Route
from roverlink.runtime.core.standard_handler import UNSTAMPED, StandardHandler, single
from roverlink.runtime.interfaces import Time


class PhTemperatureTopic(
    StandardHandler[ph_sensor_pb2.SensorBoardPHInfo, sensor_msgs.Temperature]
):
    """One reading of the pH probe.

    Extra topic of the row ph_info, number 1 of the envelope, from the peer hardware to
    the topic ph/temperature.
    """

    route = Route(
        number=1,
        name="ph_info",
        topic="ph/temperature",
        direction="hardware_to_ros",
        board="SensorBoard",
    )
    payload_type = ph_sensor_pb2.SensorBoardPHInfo
    message_type = sensor_msgs.Temperature

    @staticmethod
    def to_ros(
        payload: ph_sensor_pb2.SensorBoardPHInfo,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.Temperature:
        """Convert SensorBoardPHInfo to sensor_msgs/msg/Temperature; `stamp` is the time of reception."""
        return sensor_msgs.Temperature(
            header=std_msgs.Header(stamp=stamp, frame_id="ph_link"),
            temperature=payload.temperature,
        )

    @staticmethod
    def from_ros(message: sensor_msgs.Temperature) -> ph_sensor_pb2.SensorBoardPHInfo:
        """Convert sensor_msgs/msg/Temperature to SensorBoardPHInfo.

        Fields of the payload that the message does not contain keep their defaults:
        ph_value, voltage, state, error_code.
        """
        return ph_sensor_pb2.SensorBoardPHInfo(
            temperature=single(message.temperature),
        )
