# Generated from mapping.yaml (row pressure_info) and components/sensor_board/pressure_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""pressure_info (15): SensorBoardPressureInfo to sensor_msgs/msg/FluidPressure on pressure/fluid_pressure."""

from __future__ import annotations

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2.components.sensor_board import pressure_sensor_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed, single
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(
    sensor_msgs.FluidPressure(header=std_msgs.Header(frame_id="pressure_link")),
    ["header.stamp", "fluid_pressure"],
)
_UP_TO_HEADER_STAMP_SEC, _UP_TO_FLUID_PRESSURE, _REST = _CDR.constants
_PACK = _CDR.layout.pack


class PressureInfoPressureFluidPressureFeed(
    Feed[pressure_sensor_pb2.SensorBoardPressureInfo, sensor_msgs.FluidPressure],
):
    """SensorBoardPressureInfo to sensor_msgs/FluidPressure on the topic pressure/fluid_pressure."""

    route = Route(
        number=15,
        name="pressure_info",
        topic="pressure/fluid_pressure",
        direction="hardware_to_ros",
    )
    payload_type = pressure_sensor_pb2.SensorBoardPressureInfo
    message_type = sensor_msgs.FluidPressure

    @staticmethod
    def to_ros(
        payload: pressure_sensor_pb2.SensorBoardPressureInfo,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.FluidPressure:
        """The message that says what the payload says."""
        return sensor_msgs.FluidPressure(
            header=std_msgs.Header(stamp=stamp, frame_id="pressure_link"),
            fluid_pressure=payload.pressure_kpa * 1_000.0,
        )

    @staticmethod
    def from_ros(
        message: sensor_msgs.FluidPressure,
    ) -> pressure_sensor_pb2.SensorBoardPressureInfo:
        """The payload that says what the message says.

        It says nothing of sensor_index, temperature_c, voltage, is_calibrated, state,
        error_code.
        """
        return pressure_sensor_pb2.SensorBoardPressureInfo(
            pressure_kpa=single(message.fluid_pressure / 1_000.0),
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
            _UP_TO_FLUID_PRESSURE,
            payload.pressure_kpa * 1_000.0,
            _REST,
        )
