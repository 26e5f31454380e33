# Generated from mapping.yaml (row sensor_diag) and components/sensor_board/diagnostics.proto; do not edit.
# Regenerate with: roverlink generate
"""sensor_diag (11): SensorBoardDiagnostics to comms/msg/SensorBoardDiagnostics on sensor_board_diagnostics."""

from __future__ import annotations

from generated.handlers.gps_info import GpsInfoHandler
from generated.handlers.imu_info import ImuInfoHandler
from generated.handlers.load_cell_info import LoadCellInfoHandler
from generated.handlers.ph_info import PhInfoHandler
from generated.handlers.pressure_info import PressureInfoHandler
from generated.messages import SensorBoardDiagnostics
from generated.pb2.components.sensor_board import diagnostics_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(SensorBoardDiagnostics)


class SensorDiagHandler(
    Handler[diagnostics_pb2.SensorBoardDiagnostics, SensorBoardDiagnostics],
):
    """SensorBoardDiagnostics to the topic sensor_board_diagnostics."""

    route = Route(
        number=11,
        name="sensor_diag",
        topic="sensor_board_diagnostics",
        direction="hardware_to_ros",
        forward=("basestation",),
    )
    payload_type = diagnostics_pb2.SensorBoardDiagnostics
    message_type = SensorBoardDiagnostics

    @staticmethod
    def to_ros(
        payload: diagnostics_pb2.SensorBoardDiagnostics,
    ) -> SensorBoardDiagnostics:
        """The message that says what the payload says."""
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
        """The payload that says what the message says."""
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

    def pack(self, payload: diagnostics_pb2.SensorBoardDiagnostics) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        ph_sensor = payload.ph_sensor
        imu_sensor = payload.imu_sensor
        gps_sensor_1 = payload.gps_sensor_1
        load_cell = payload.load_cell
        pressure_sensor = payload.pressure_sensor
        return _CDR.pack(
            cdr.LITTLE_ENDIAN,
            payload.state,
            ph_sensor.ph_value,
            ph_sensor.voltage,
            ph_sensor.temperature,
            ph_sensor.state,
            ph_sensor.error_code,
            imu_sensor.accel_x,
            imu_sensor.accel_y,
            imu_sensor.accel_z,
            imu_sensor.gyro_x,
            imu_sensor.gyro_y,
            imu_sensor.gyro_z,
            imu_sensor.mag_x,
            imu_sensor.mag_y,
            imu_sensor.mag_z,
            imu_sensor.is_calibrated,
            imu_sensor.state,
            imu_sensor.error_code,
            payload.board_temperature,
            payload.board_voltage,
            gps_sensor_1.latitude,
            gps_sensor_1.longitude,
            gps_sensor_1.altitude,
            gps_sensor_1.speed,
            gps_sensor_1.heading,
            gps_sensor_1.hdop,
            gps_sensor_1.vdop,
            gps_sensor_1.satellites,
            gps_sensor_1.fix_quality,
            gps_sensor_1.state,
            gps_sensor_1.error_code,
            gps_sensor_1.utc_timestamp,
            load_cell.sensor_index,
            load_cell.force_newtons,
            load_cell.mass_grams,
            load_cell.raw_counts,
            load_cell.is_calibrated,
            load_cell.scale_newtons_per_count,
            load_cell.tare_offset_counts,
            load_cell.state,
            load_cell.error_code,
            pressure_sensor.sensor_index,
            pressure_sensor.pressure_kpa,
            pressure_sensor.temperature_c,
            pressure_sensor.voltage,
            pressure_sensor.is_calibrated,
            pressure_sensor.state,
            pressure_sensor.error_code,
        )
