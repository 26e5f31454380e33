# Generated from mapping.yaml (row gps_info) and components/sensor_board/gps_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of SensorBoardGPSInfo as sensor_msgs/msg/NavSatFix.

The registry uses this class; programs import `GpsFixTopic`
from `generated.extra_topics.gps_fix`.
"""

from __future__ import annotations

from generated.extra_topics.gps_fix import FIX_QUALITY, GpsFixTopic
from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2.components.sensor_board import gps_sensor_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.standard_handler import UNSTAMPED
from roverlink.runtime.interfaces import Time

# Constant fields are serialized only once. The bytes of the other fields are inserted between them.
_SERIALIZED = cdr.template(
    sensor_msgs.NavSatFix(
        header=std_msgs.Header(frame_id="gps_link"),
        status=sensor_msgs.NavSatStatus(service=sensor_msgs.NavSatStatus.SERVICE_GPS),
        position_covariance=[6.25, 0.0, 0.0, 0.0, 6.25, 0.0, 0.0, 0.0, 25.0],
        position_covariance_type=sensor_msgs.NavSatFix.COVARIANCE_TYPE_APPROXIMATED,
    ),
    [
        "header.stamp",
        "status.status",
        "latitude",
        "longitude",
        "altitude",
    ],
)
_BEFORE_HEADER_STAMP_SEC, _BEFORE_STATUS_STATUS, _BEFORE_LATITUDE, _END = (
    _SERIALIZED.constants
)
_LAYOUT = _SERIALIZED.layout


class FastGpsFixTopic(GpsFixTopic):
    """GpsFixTopic that converts a payload to a serialized ROS message in one step."""

    def _pack(
        self, payload: gps_sensor_pb2.SensorBoardGPSInfo, stamp: Time = UNSTAMPED
    ) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            _BEFORE_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _BEFORE_STATUS_STATUS,
            FIX_QUALITY[payload.fix_quality],
            _BEFORE_LATITUDE,
            payload.latitude,
            payload.longitude,
            payload.altitude,
            _END,
        )
