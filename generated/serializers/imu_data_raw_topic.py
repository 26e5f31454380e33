# Generated from mapping.yaml (row imu_info) and components/sensor_board/imu_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of SensorBoardIMUInfo as sensor_msgs/msg/Imu.

The registry uses this class; programs import `ImuDataRawTopic`
from `generated.extra_topics.imu_data_raw`.
"""

from __future__ import annotations

from generated.extra_topics.imu_data_raw import DEG_TO_RAD, ImuDataRawTopic
from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2.components.sensor_board import imu_sensor_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.standard_handler import UNSTAMPED
from roverlink.runtime.interfaces import Time

# Constant fields are serialized only once. The bytes of the other fields are inserted between them.
_SERIALIZED = cdr.template(
    sensor_msgs.Imu(
        header=std_msgs.Header(frame_id="imu_link"),
        orientation_covariance=[-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    ),
    [
        "header.stamp",
        "angular_velocity",
        "linear_acceleration",
    ],
)
(
    _BEFORE_HEADER_STAMP_SEC,
    _BEFORE_ANGULAR_VELOCITY_X,
    _BEFORE_LINEAR_ACCELERATION_X,
    _END,
) = _SERIALIZED.constants
_LAYOUT = _SERIALIZED.layout


class FastImuDataRawTopic(ImuDataRawTopic):
    """ImuDataRawTopic that converts a payload to a serialized ROS message in one step."""

    def _pack(
        self, payload: imu_sensor_pb2.SensorBoardIMUInfo, stamp: Time = UNSTAMPED
    ) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            _BEFORE_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _BEFORE_ANGULAR_VELOCITY_X,
            payload.gyro_x * DEG_TO_RAD,
            payload.gyro_y * DEG_TO_RAD,
            payload.gyro_z * DEG_TO_RAD,
            _BEFORE_LINEAR_ACCELERATION_X,
            payload.accel_x,
            payload.accel_y,
            payload.accel_z,
            _END,
        )
