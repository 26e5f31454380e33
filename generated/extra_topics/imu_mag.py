# Generated from mapping.yaml (row imu_info) and components/sensor_board/imu_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the topic imu/mag: SensorBoardIMUInfo and sensor_msgs/msg/MagneticField."""

from __future__ import annotations

from generated.interfaces import geometry_msgs, sensor_msgs, std_msgs
from generated.pb2.components.sensor_board import imu_sensor_pb2
from roverlink.runtime.core.handler import Route
from roverlink.runtime.core.standard_handler import UNSTAMPED, StandardHandler, single
from roverlink.runtime.interfaces import Time


class ImuMagTopic(
    StandardHandler[imu_sensor_pb2.SensorBoardIMUInfo, sensor_msgs.MagneticField]
):
    """One sample of the inertial measurement unit.

    Extra topic of the row imu_info, number 13 of the envelope, from the peer hardware
    to the topic imu/mag.
    """

    route = Route(
        number=13,
        name="imu_info",
        topic="imu/mag",
        direction="hardware_to_ros",
        board="SensorBoard",
    )
    payload_type = imu_sensor_pb2.SensorBoardIMUInfo
    message_type = sensor_msgs.MagneticField

    @staticmethod
    def to_ros(
        payload: imu_sensor_pb2.SensorBoardIMUInfo,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.MagneticField:
        """Convert SensorBoardIMUInfo to sensor_msgs/msg/MagneticField; `stamp` is the time of reception."""
        return sensor_msgs.MagneticField(
            header=std_msgs.Header(stamp=stamp, frame_id="imu_link"),
            magnetic_field=geometry_msgs.Vector3(
                x=payload.mag_x / 1_000_000.0,
                y=payload.mag_y / 1_000_000.0,
                z=payload.mag_z / 1_000_000.0,
            ),
        )

    @staticmethod
    def from_ros(
        message: sensor_msgs.MagneticField,
    ) -> imu_sensor_pb2.SensorBoardIMUInfo:
        """Convert sensor_msgs/msg/MagneticField to SensorBoardIMUInfo.

        Fields of the payload that the message does not contain keep their defaults:
        accel_x, accel_y, accel_z, gyro_x, gyro_y, gyro_z, is_calibrated, state,
        error_code.
        """
        return imu_sensor_pb2.SensorBoardIMUInfo(
            mag_x=single(message.magnetic_field.x * 1_000_000.0),
            mag_y=single(message.magnetic_field.y * 1_000_000.0),
            mag_z=single(message.magnetic_field.z * 1_000_000.0),
        )
