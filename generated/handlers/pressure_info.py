# Generated from mapping.yaml (row pressure_info) and components/sensor_board/pressure_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""pressure_info (15): SensorBoardPressureInfo to comms/msg/SensorBoardPressureInfo on pressure_info."""

from __future__ import annotations

from generated.messages import SensorBoardPressureInfo, SensorState
from generated.pb2.components.sensor_board import pressure_sensor_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(SensorBoardPressureInfo)


class PressureInfoHandler(
    Handler[pressure_sensor_pb2.SensorBoardPressureInfo, SensorBoardPressureInfo],
):
    """SensorBoardPressureInfo to the topic pressure_info."""

    route = Route(
        number=15,
        name="pressure_info",
        topic="pressure_info",
        direction="hardware_to_ros",
        forward=("basestation",),
    )
    payload_type = pressure_sensor_pb2.SensorBoardPressureInfo
    message_type = SensorBoardPressureInfo

    @staticmethod
    def to_ros(
        payload: pressure_sensor_pb2.SensorBoardPressureInfo,
    ) -> SensorBoardPressureInfo:
        """The message that says what the payload says."""
        return SensorBoardPressureInfo(
            sensor_index=payload.sensor_index,
            pressure_kpa=payload.pressure_kpa,
            temperature_c=payload.temperature_c,
            voltage=payload.voltage,
            is_calibrated=payload.is_calibrated,
            state=SensorState(state=payload.state),
            error_code=payload.error_code,
        )

    @staticmethod
    def from_ros(
        message: SensorBoardPressureInfo,
    ) -> pressure_sensor_pb2.SensorBoardPressureInfo:
        """The payload that says what the message says."""
        return pressure_sensor_pb2.SensorBoardPressureInfo(
            sensor_index=message.sensor_index,
            pressure_kpa=message.pressure_kpa,
            temperature_c=message.temperature_c,
            voltage=message.voltage,
            is_calibrated=message.is_calibrated,
            state=message.state.state,
            error_code=message.error_code,
        )

    def pack(self, payload: pressure_sensor_pb2.SensorBoardPressureInfo) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(
            cdr.LITTLE_ENDIAN,
            payload.sensor_index,
            payload.pressure_kpa,
            payload.temperature_c,
            payload.voltage,
            payload.is_calibrated,
            payload.state,
            payload.error_code,
        )
