# Generated from mapping.yaml (row imu_info) and components/sensor_board/imu_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row imu_info: SensorBoardIMUInfo and comms/msg/ImuSensorInformation."""

from __future__ import annotations

from generated.messages import ImuSensorInformation, SensorState
from generated.pb2.components.sensor_board import imu_sensor_pb2
from roverlink.runtime.core.handler import Handler, Route


class ImuInfoHandler(Handler[imu_sensor_pb2.SensorBoardIMUInfo, ImuSensorInformation]):
    """One sample of the inertial measurement unit.

    Number 13 of the envelope, from the peer hardware to the topic imu_data.
    """

    route = Route(
        number=13,
        name="imu_info",
        topic="imu_data",
        direction="hardware_to_ros",
        forward=("basestation",),
        board="SensorBoard",
    )
    payload_type = imu_sensor_pb2.SensorBoardIMUInfo
    message_type = ImuSensorInformation

    @staticmethod
    def to_ros(payload: imu_sensor_pb2.SensorBoardIMUInfo) -> ImuSensorInformation:
        """Convert SensorBoardIMUInfo to comms/msg/ImuSensorInformation."""
        return ImuSensorInformation(
            accel_x=payload.accel_x,
            accel_y=payload.accel_y,
            accel_z=payload.accel_z,
            gyro_x=payload.gyro_x,
            gyro_y=payload.gyro_y,
            gyro_z=payload.gyro_z,
            mag_x=payload.mag_x,
            mag_y=payload.mag_y,
            mag_z=payload.mag_z,
            is_calibrated=payload.is_calibrated,
            state=SensorState(state=payload.state),
            error_code=payload.error_code,
        )

    @staticmethod
    def from_ros(message: ImuSensorInformation) -> imu_sensor_pb2.SensorBoardIMUInfo:
        """Convert comms/msg/ImuSensorInformation to SensorBoardIMUInfo."""
        return imu_sensor_pb2.SensorBoardIMUInfo(
            accel_x=message.accel_x,
            accel_y=message.accel_y,
            accel_z=message.accel_z,
            gyro_x=message.gyro_x,
            gyro_y=message.gyro_y,
            gyro_z=message.gyro_z,
            mag_x=message.mag_x,
            mag_y=message.mag_y,
            mag_z=message.mag_z,
            is_calibrated=message.is_calibrated,
            state=message.state.state,
            error_code=message.error_code,
        )
