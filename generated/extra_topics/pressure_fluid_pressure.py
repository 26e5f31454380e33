# Generated from mapping.yaml (row pressure_info) and components/sensor_board/pressure_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the topic pressure/fluid_pressure: SensorBoardPressureInfo and sensor_msgs/msg/FluidPressure."""

from __future__ import annotations

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2.components.sensor_board import pressure_sensor_pb2
from roverlink.runtime.core.handler import Route
from roverlink.runtime.core.standard_handler import UNSTAMPED, StandardHandler, single
from roverlink.runtime.interfaces import Time


class PressureFluidPressureTopic(
    StandardHandler[
        pressure_sensor_pb2.SensorBoardPressureInfo, sensor_msgs.FluidPressure
    ]
):
    """One reading of a pressure sensor.

    Extra topic of the row pressure_info, number 15 of the envelope, from the peer
    hardware to the topic pressure/fluid_pressure.
    """

    route = Route(
        number=15,
        name="pressure_info",
        topic="pressure/fluid_pressure",
        direction="hardware_to_ros",
        board="SensorBoard",
    )
    payload_type = pressure_sensor_pb2.SensorBoardPressureInfo
    message_type = sensor_msgs.FluidPressure

    @staticmethod
    def to_ros(
        payload: pressure_sensor_pb2.SensorBoardPressureInfo,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.FluidPressure:
        """Convert SensorBoardPressureInfo to sensor_msgs/msg/FluidPressure; `stamp` is the time of reception."""
        return sensor_msgs.FluidPressure(
            header=std_msgs.Header(stamp=stamp, frame_id="pressure_link"),
            fluid_pressure=payload.pressure_kpa * 1_000.0,
        )

    @staticmethod
    def from_ros(
        message: sensor_msgs.FluidPressure,
    ) -> pressure_sensor_pb2.SensorBoardPressureInfo:
        """Convert sensor_msgs/msg/FluidPressure to SensorBoardPressureInfo.

        Fields of the payload that the message does not contain keep their defaults:
        sensor_index, temperature_c, voltage, is_calibrated, state, error_code.
        """
        return pressure_sensor_pb2.SensorBoardPressureInfo(
            pressure_kpa=single(message.fluid_pressure / 1_000.0),
        )
