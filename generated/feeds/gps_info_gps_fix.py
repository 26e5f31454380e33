# Generated from mapping.yaml (row gps_info) and components/sensor_board/gps_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""gps_info (12): SensorBoardGPSInfo to sensor_msgs/msg/NavSatFix on gps/fix."""

from __future__ import annotations

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2.components.sensor_board import gps_sensor_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.core.feed import UNSTAMPED, Counterparts, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_FIX_QUALITY = Counterparts(
    "fix_quality",
    {
        0: sensor_msgs.NavSatStatus.STATUS_NO_FIX,  # NO_FIX
        1: sensor_msgs.NavSatStatus.STATUS_FIX,  # GPS_FIX
        2: sensor_msgs.NavSatStatus.STATUS_SBAS_FIX,  # DGPS_FIX
        3: sensor_msgs.NavSatStatus.STATUS_FIX,  # PPS_FIX
        4: sensor_msgs.NavSatStatus.STATUS_GBAS_FIX,  # RTK_FIX
        5: sensor_msgs.NavSatStatus.STATUS_GBAS_FIX,  # RTK_FLOAT
    },
)
_CDR = cdr.template(
    sensor_msgs.NavSatFix(
        header=std_msgs.Header(frame_id="gps_link"),
        status=sensor_msgs.NavSatStatus(service=1),
    ),
    ["header.stamp", "status.status", "latitude", "longitude", "altitude"],
)
_UP_TO_HEADER_STAMP_SEC, _UP_TO_STATUS_STATUS, _UP_TO_LATITUDE, _REST = _CDR.constants
_PACK = _CDR.layout.pack


class GpsInfoGpsFixFeed(Feed[gps_sensor_pb2.SensorBoardGPSInfo, sensor_msgs.NavSatFix]):
    """SensorBoardGPSInfo to sensor_msgs/NavSatFix on the topic gps/fix."""

    route = Route(
        number=12,
        name="gps_info",
        topic="gps/fix",
        direction="hardware_to_ros",
    )
    payload_type = gps_sensor_pb2.SensorBoardGPSInfo
    message_type = sensor_msgs.NavSatFix

    @staticmethod
    def to_ros(
        payload: gps_sensor_pb2.SensorBoardGPSInfo,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.NavSatFix:
        """The message that says what the payload says."""
        return sensor_msgs.NavSatFix(
            header=std_msgs.Header(stamp=stamp, frame_id="gps_link"),
            status=sensor_msgs.NavSatStatus(
                status=_FIX_QUALITY[payload.fix_quality],
                service=1,
            ),
            latitude=payload.latitude,
            longitude=payload.longitude,
            altitude=payload.altitude,
        )

    @staticmethod
    def from_ros(_message: sensor_msgs.NavSatFix) -> gps_sensor_pb2.SensorBoardGPSInfo:
        """There is no way back: status.status is STATUS_FIX for GPS_FIX and for PPS_FIX of fix_quality."""
        raise ConversionError(
            "status.status is STATUS_FIX for GPS_FIX and for PPS_FIX of fix_quality",
        )

    def pack(
        self,
        payload: gps_sensor_pb2.SensorBoardGPSInfo,
        stamp: Time = UNSTAMPED,
    ) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(
            _UP_TO_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _UP_TO_STATUS_STATUS,
            _FIX_QUALITY[payload.fix_quality],
            _UP_TO_LATITUDE,
            payload.latitude,
            payload.longitude,
            payload.altitude,
            _REST,
        )
