# Generated from mapping.yaml (row imu_info) and components/sensor_board/imu_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of SensorBoardIMUInfo as sensor_msgs/msg/MagneticField.

The registry uses this class; programs import `ImuMagTopic`
from `generated.extra_topics.imu_mag`.
"""

from __future__ import annotations

from generated.extra_topics.imu_mag import ImuMagTopic
from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2.components.sensor_board import imu_sensor_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.standard_handler import UNSTAMPED
from roverlink.runtime.interfaces import Time

# Constant fields are serialized only once. The bytes of the other fields are inserted between them.
_SERIALIZED = cdr.template(
    sensor_msgs.MagneticField(header=std_msgs.Header(frame_id="imu_link")),
    [
        "header.stamp",
        "magnetic_field",
    ],
)
_BEFORE_HEADER_STAMP_SEC, _BEFORE_MAGNETIC_FIELD_X, _END = _SERIALIZED.constants
_LAYOUT = _SERIALIZED.layout


class FastImuMagTopic(ImuMagTopic):
    """ImuMagTopic that converts a payload to a serialized ROS message in one step."""

    def _pack(
        self, payload: imu_sensor_pb2.SensorBoardIMUInfo, stamp: Time = UNSTAMPED
    ) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            _BEFORE_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _BEFORE_MAGNETIC_FIELD_X,
            payload.mag_x / 1_000_000.0,
            payload.mag_y / 1_000_000.0,
            payload.mag_z / 1_000_000.0,
            _END,
        )
