# Generated from mapping.yaml (row gps_info) and components/sensor_board/gps_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the topic gps/fix: SensorBoardGPSInfo and sensor_msgs/msg/NavSatFix."""

from __future__ import annotations

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2.components.sensor_board import gps_sensor_pb2
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.core.handler import Route
from roverlink.runtime.core.standard_handler import (
    UNSTAMPED,
    Counterparts,
    StandardHandler,
)
from roverlink.runtime.interfaces import Time

FIX_QUALITY = Counterparts(
    "fix_quality",
    {
        gps_sensor_pb2.GPSFixQuality.NO_FIX: sensor_msgs.NavSatStatus.STATUS_NO_FIX,
        gps_sensor_pb2.GPSFixQuality.GPS_FIX: sensor_msgs.NavSatStatus.STATUS_FIX,
        gps_sensor_pb2.GPSFixQuality.DGPS_FIX: sensor_msgs.NavSatStatus.STATUS_SBAS_FIX,
        gps_sensor_pb2.GPSFixQuality.PPS_FIX: sensor_msgs.NavSatStatus.STATUS_FIX,
        gps_sensor_pb2.GPSFixQuality.RTK_FIX: sensor_msgs.NavSatStatus.STATUS_GBAS_FIX,
        gps_sensor_pb2.GPSFixQuality.RTK_FLOAT: sensor_msgs.NavSatStatus.STATUS_GBAS_FIX,
    },
)


class GpsFixTopic(
    StandardHandler[gps_sensor_pb2.SensorBoardGPSInfo, sensor_msgs.NavSatFix]
):
    """One fix of the GPS receiver.

    Extra topic of the row gps_info, number 12 of the envelope, from the peer hardware
    to the topic gps/fix.
    """

    route = Route(
        number=12,
        name="gps_info",
        topic="gps/fix",
        direction="hardware_to_ros",
        board="SensorBoard",
    )
    payload_type = gps_sensor_pb2.SensorBoardGPSInfo
    message_type = sensor_msgs.NavSatFix

    @staticmethod
    def to_ros(
        payload: gps_sensor_pb2.SensorBoardGPSInfo,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.NavSatFix:
        """Convert SensorBoardGPSInfo to sensor_msgs/msg/NavSatFix; `stamp` is the time of reception."""
        return sensor_msgs.NavSatFix(
            header=std_msgs.Header(stamp=stamp, frame_id="gps_link"),
            status=sensor_msgs.NavSatStatus(
                status=FIX_QUALITY[payload.fix_quality],
                service=sensor_msgs.NavSatStatus.SERVICE_GPS,
            ),
            latitude=payload.latitude,
            longitude=payload.longitude,
            altitude=payload.altitude,
            position_covariance=[6.25, 0.0, 0.0, 0.0, 6.25, 0.0, 0.0, 0.0, 25.0],
            position_covariance_type=sensor_msgs.NavSatFix.COVARIANCE_TYPE_APPROXIMATED,
        )

    @staticmethod
    def from_ros(message: sensor_msgs.NavSatFix) -> gps_sensor_pb2.SensorBoardGPSInfo:
        """Raise `ConversionError`: the message does not determine the payload."""
        del message  # nothing of it is used
        raise ConversionError(
            "sensor_msgs/msg/NavSatFix cannot be converted to SensorBoardGPSInfo: 'status.status' is STATUS_FIX for 'GPS_FIX' and for 'PPS_FIX' of 'fix_quality'"
        )
