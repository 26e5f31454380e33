# Generated from mapping.yaml (row sensor_diag) and components/sensor_board/diagnostics.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of SensorBoardDiagnostics as comms/msg/SensorBoardDiagnostics.

The registry uses this class; programs import `SensorDiagHandler`
from `generated.handlers.sensor_diag`.
"""

from __future__ import annotations

from generated.handlers.sensor_diag import SensorDiagHandler
from generated.messages import SensorBoardDiagnostics
from generated.pb2.components.sensor_board import diagnostics_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(SensorBoardDiagnostics)


class FastSensorDiagHandler(SensorDiagHandler):
    """SensorDiagHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(self, payload: diagnostics_pb2.SensorBoardDiagnostics) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        ph_sensor = payload.ph_sensor
        imu_sensor = payload.imu_sensor
        gps_sensor_1 = payload.gps_sensor_1
        load_cell = payload.load_cell
        pressure_sensor = payload.pressure_sensor
        return _LAYOUT.pack(
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
