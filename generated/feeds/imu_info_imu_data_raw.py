# Generated from mapping.yaml (row imu_info) and components/sensor_board/imu_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""imu_info (13): SensorBoardIMUInfo to sensor_msgs/msg/Imu on imu/data_raw."""

from __future__ import annotations

import math

from generated.interfaces import geometry_msgs, sensor_msgs, std_msgs
from generated.pb2.components.sensor_board import imu_sensor_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed, single
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_DEG_TO_RAD = math.pi / 180
_CDR = cdr.template(
    sensor_msgs.Imu(
        header=std_msgs.Header(frame_id="imu_link"),
        orientation_covariance=[-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    ),
    ["header.stamp", "angular_velocity", "linear_acceleration"],
)
(
    _UP_TO_HEADER_STAMP_SEC,
    _UP_TO_ANGULAR_VELOCITY_X,
    _UP_TO_LINEAR_ACCELERATION_X,
    _REST,
) = _CDR.constants
_PACK = _CDR.layout.pack


class ImuInfoImuDataRawFeed(Feed[imu_sensor_pb2.SensorBoardIMUInfo, sensor_msgs.Imu]):
    """SensorBoardIMUInfo to sensor_msgs/Imu on the topic imu/data_raw."""

    route = Route(
        number=13,
        name="imu_info",
        topic="imu/data_raw",
        direction="hardware_to_ros",
    )
    payload_type = imu_sensor_pb2.SensorBoardIMUInfo
    message_type = sensor_msgs.Imu

    @staticmethod
    def to_ros(
        payload: imu_sensor_pb2.SensorBoardIMUInfo,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.Imu:
        """The message that says what the payload says."""
        return sensor_msgs.Imu(
            header=std_msgs.Header(stamp=stamp, frame_id="imu_link"),
            orientation_covariance=[-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            angular_velocity=geometry_msgs.Vector3(
                x=payload.gyro_x * _DEG_TO_RAD,
                y=payload.gyro_y * _DEG_TO_RAD,
                z=payload.gyro_z * _DEG_TO_RAD,
            ),
            linear_acceleration=geometry_msgs.Vector3(
                x=payload.accel_x,
                y=payload.accel_y,
                z=payload.accel_z,
            ),
        )

    @staticmethod
    def from_ros(message: sensor_msgs.Imu) -> imu_sensor_pb2.SensorBoardIMUInfo:
        """The payload that says what the message says.

        It says nothing of mag_x, mag_y, mag_z, is_calibrated, state, error_code.
        """
        return imu_sensor_pb2.SensorBoardIMUInfo(
            gyro_x=single(message.angular_velocity.x / _DEG_TO_RAD),
            gyro_y=single(message.angular_velocity.y / _DEG_TO_RAD),
            gyro_z=single(message.angular_velocity.z / _DEG_TO_RAD),
            accel_x=single(message.linear_acceleration.x),
            accel_y=single(message.linear_acceleration.y),
            accel_z=single(message.linear_acceleration.z),
        )

    def pack(
        self,
        payload: imu_sensor_pb2.SensorBoardIMUInfo,
        stamp: Time = UNSTAMPED,
    ) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(
            _UP_TO_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _UP_TO_ANGULAR_VELOCITY_X,
            payload.gyro_x * _DEG_TO_RAD,
            payload.gyro_y * _DEG_TO_RAD,
            payload.gyro_z * _DEG_TO_RAD,
            _UP_TO_LINEAR_ACCELERATION_X,
            payload.accel_x,
            payload.accel_y,
            payload.accel_z,
            _REST,
        )
