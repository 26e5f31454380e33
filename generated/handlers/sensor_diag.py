# Generated from mapping.yaml (row sensor_diag) and components/sensor_board/diagnostics.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row sensor_diag: SensorBoardDiagnostics and comms/msg/SensorBoardDiagnostics."""

from __future__ import annotations

from generated.handlers.gps_info import GpsInfoHandler
from generated.handlers.imu_info import ImuInfoHandler
from generated.handlers.load_cell_info import LoadCellInfoHandler
from generated.handlers.ph_info import PhInfoHandler
from generated.handlers.pressure_info import PressureInfoHandler
from generated.messages import SensorBoardDiagnostics
from generated.pb2.components.sensor_board import diagnostics_pb2
from roverlink.runtime.core.handler import Handler, Route


class SensorDiagHandler(
    Handler[diagnostics_pb2.SensorBoardDiagnostics, SensorBoardDiagnostics]
):
    """State of the sensor board, with the latest reading of each of its sensors.

    Number 11 of the envelope, from the peer hardware to the topic
    sensor_board_diagnostics.
    """

    route = Route(
        number=11,
        name="sensor_diag",
        topic="sensor_board_diagnostics",
        direction="hardware_to_ros",
        forward=("basestation",),
        board="SensorBoard",
    )
    payload_type = diagnostics_pb2.SensorBoardDiagnostics
    message_type = SensorBoardDiagnostics

    @staticmethod
    def to_ros(
        payload: diagnostics_pb2.SensorBoardDiagnostics,
    ) -> SensorBoardDiagnostics:
        """Convert SensorBoardDiagnostics to comms/msg/SensorBoardDiagnostics."""
        return SensorBoardDiagnostics(
            state=payload.state,
            ph_sensor=PhInfoHandler.to_ros(payload.ph_sensor),
            imu_sensor=ImuInfoHandler.to_ros(payload.imu_sensor),
            board_temperature=payload.board_temperature,
            board_voltage=payload.board_voltage,
            gps_sensor=GpsInfoHandler.to_ros(payload.gps_sensor_1),
            load_cell=LoadCellInfoHandler.to_ros(payload.load_cell),
            pressure_sensor=PressureInfoHandler.to_ros(payload.pressure_sensor),
        )

    @staticmethod
    def from_ros(
        message: SensorBoardDiagnostics,
    ) -> diagnostics_pb2.SensorBoardDiagnostics:
        """Convert comms/msg/SensorBoardDiagnostics to SensorBoardDiagnostics."""
        return diagnostics_pb2.SensorBoardDiagnostics(
            state=message.state,
            ph_sensor=PhInfoHandler.from_ros(message.ph_sensor),
            imu_sensor=ImuInfoHandler.from_ros(message.imu_sensor),
            board_temperature=message.board_temperature,
            board_voltage=message.board_voltage,
            gps_sensor_1=GpsInfoHandler.from_ros(message.gps_sensor),
            load_cell=LoadCellInfoHandler.from_ros(message.load_cell),
            pressure_sensor=PressureInfoHandler.from_ros(message.pressure_sensor),
        )
