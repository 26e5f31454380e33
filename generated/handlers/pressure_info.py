# Generated from mapping.yaml (row pressure_info) and components/sensor_board/pressure_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row pressure_info: SensorBoardPressureInfo and comms/msg/SensorBoardPressureInfo."""

from __future__ import annotations

from generated.messages import SensorBoardPressureInfo, SensorState
from generated.pb2.components.sensor_board import pressure_sensor_pb2
from roverlink.runtime.core.handler import Handler, Route


class PressureInfoHandler(
    Handler[pressure_sensor_pb2.SensorBoardPressureInfo, SensorBoardPressureInfo]
):
    """One reading of a pressure sensor.

    Number 15 of the envelope, from the peer hardware to the topic pressure_info.
    """

    route = Route(
        number=15,
        name="pressure_info",
        topic="pressure_info",
        direction="hardware_to_ros",
        forward=("basestation",),
        board="SensorBoard",
    )
    payload_type = pressure_sensor_pb2.SensorBoardPressureInfo
    message_type = SensorBoardPressureInfo

    @staticmethod
    def to_ros(
        payload: pressure_sensor_pb2.SensorBoardPressureInfo,
    ) -> SensorBoardPressureInfo:
        """Convert SensorBoardPressureInfo to comms/msg/SensorBoardPressureInfo."""
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
        """Convert comms/msg/SensorBoardPressureInfo to SensorBoardPressureInfo."""
        return pressure_sensor_pb2.SensorBoardPressureInfo(
            sensor_index=message.sensor_index,
            pressure_kpa=message.pressure_kpa,
            temperature_c=message.temperature_c,
            voltage=message.voltage,
            is_calibrated=message.is_calibrated,
            state=message.state.state,
            error_code=message.error_code,
        )
