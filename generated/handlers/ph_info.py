# Generated from mapping.yaml (row ph_info) and components/sensor_board/ph_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row ph_info: SensorBoardPHInfo and comms/msg/SensorBoardPHInfo."""

from __future__ import annotations

from generated.messages import SensorBoardPHInfo, SensorState
from generated.pb2.components.sensor_board import ph_sensor_pb2
from roverlink.runtime.core.handler import Handler, Route


class PhInfoHandler(Handler[ph_sensor_pb2.SensorBoardPHInfo, SensorBoardPHInfo]):
    """One reading of the pH probe.

    Number 1 of the envelope, from the peer hardware to the topic ph_data.
    """

    route = Route(
        number=1,
        name="ph_info",
        topic="ph_data",
        direction="hardware_to_ros",
        forward=("basestation",),
        board="SensorBoard",
    )
    payload_type = ph_sensor_pb2.SensorBoardPHInfo
    message_type = SensorBoardPHInfo

    @staticmethod
    def to_ros(payload: ph_sensor_pb2.SensorBoardPHInfo) -> SensorBoardPHInfo:
        """Convert SensorBoardPHInfo to comms/msg/SensorBoardPHInfo."""
        return SensorBoardPHInfo(
            ph_value=payload.ph_value,
            voltage=payload.voltage,
            temperature=payload.temperature,
            state=SensorState(state=payload.state),
            error_code=payload.error_code,
        )

    @staticmethod
    def from_ros(message: SensorBoardPHInfo) -> ph_sensor_pb2.SensorBoardPHInfo:
        """Convert comms/msg/SensorBoardPHInfo to SensorBoardPHInfo."""
        return ph_sensor_pb2.SensorBoardPHInfo(
            ph_value=message.ph_value,
            voltage=message.voltage,
            temperature=message.temperature,
            state=message.state.state,
            error_code=message.error_code,
        )
