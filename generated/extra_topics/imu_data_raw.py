# Generated from mapping.yaml (row imu_info) and components/sensor_board/imu_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the topic imu/data_raw: SensorBoardIMUInfo and sensor_msgs/msg/Imu."""

from __future__ import annotations

import math

from generated.interfaces import geometry_msgs, sensor_msgs, std_msgs
from generated.pb2.components.sensor_board import imu_sensor_pb2
from roverlink.runtime.core.handler import Route
from roverlink.runtime.core.standard_handler import UNSTAMPED, StandardHandler, single
from roverlink.runtime.interfaces import Time

DEG_TO_RAD = math.pi / 180


class ImuDataRawTopic(
    StandardHandler[imu_sensor_pb2.SensorBoardIMUInfo, sensor_msgs.Imu]
):
    """One sample of the inertial measurement unit.

    Extra topic of the row imu_info, number 13 of the envelope, from the peer hardware
    to the topic imu/data_raw.
    """

    route = Route(
        number=13,
        name="imu_info",
        topic="imu/data_raw",
        direction="hardware_to_ros",
        board="SensorBoard",
    )
    payload_type = imu_sensor_pb2.SensorBoardIMUInfo
    message_type = sensor_msgs.Imu

    @staticmethod
    def to_ros(
        payload: imu_sensor_pb2.SensorBoardIMUInfo,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.Imu:
        """Convert SensorBoardIMUInfo to sensor_msgs/msg/Imu; `stamp` is the time of reception."""
        return sensor_msgs.Imu(
            header=std_msgs.Header(stamp=stamp, frame_id="imu_link"),
            orientation_covariance=[-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            angular_velocity=geometry_msgs.Vector3(
                x=payload.gyro_x * DEG_TO_RAD,
                y=payload.gyro_y * DEG_TO_RAD,
                z=payload.gyro_z * DEG_TO_RAD,
            ),
            linear_acceleration=geometry_msgs.Vector3(
                x=payload.accel_x, y=payload.accel_y, z=payload.accel_z
            ),
        )

    @staticmethod
    def from_ros(message: sensor_msgs.Imu) -> imu_sensor_pb2.SensorBoardIMUInfo:
        """Convert sensor_msgs/msg/Imu to SensorBoardIMUInfo.

        Fields of the payload that the message does not contain keep their defaults:
        mag_x, mag_y, mag_z, is_calibrated, state, error_code.
        """
        return imu_sensor_pb2.SensorBoardIMUInfo(
            gyro_x=single(message.angular_velocity.x / DEG_TO_RAD),
            gyro_y=single(message.angular_velocity.y / DEG_TO_RAD),
            gyro_z=single(message.angular_velocity.z / DEG_TO_RAD),
            accel_x=single(message.linear_acceleration.x),
            accel_y=single(message.linear_acceleration.y),
            accel_z=single(message.linear_acceleration.z),
        )
