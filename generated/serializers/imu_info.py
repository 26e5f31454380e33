# Generated from mapping.yaml (row imu_info) and components/sensor_board/imu_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of SensorBoardIMUInfo as comms/msg/ImuSensorInformation.

The registry uses this class; programs import `ImuInfoHandler`
from `generated.handlers.imu_info`.
"""

from __future__ import annotations

from generated.handlers.imu_info import ImuInfoHandler
from generated.messages import ImuSensorInformation
from generated.pb2.components.sensor_board import imu_sensor_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(ImuSensorInformation)


class FastImuInfoHandler(ImuInfoHandler):
    """ImuInfoHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(self, payload: imu_sensor_pb2.SensorBoardIMUInfo) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.accel_x,
            payload.accel_y,
            payload.accel_z,
            payload.gyro_x,
            payload.gyro_y,
            payload.gyro_z,
            payload.mag_x,
            payload.mag_y,
            payload.mag_z,
            payload.is_calibrated,
            payload.state,
            payload.error_code,
        )
