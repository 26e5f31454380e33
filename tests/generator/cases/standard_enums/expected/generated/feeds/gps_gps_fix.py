# Generated from mapping.yaml (row gps) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""gps (1): Gps to sensor_msgs/msg/NavSatFix on gps/fix."""

from __future__ import annotations

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Counterparts, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_QUALITY = Counterparts(
    "quality",
    {
        0: sensor_msgs.NavSatStatus.STATUS_NO_FIX,  # NONE
        1: sensor_msgs.NavSatStatus.STATUS_FIX,  # PLAIN
        4: sensor_msgs.NavSatStatus.STATUS_GBAS_FIX,  # RTK
    },
)
_QUALITY_BACK = _QUALITY.back("status.status")
_CDR = cdr.template(
    sensor_msgs.NavSatFix(
        header=std_msgs.Header(frame_id="gps"),
        status=sensor_msgs.NavSatStatus(service=1),
        position_covariance_type=0,
    ),
    ["header.stamp", "status.status", "latitude", "longitude", "altitude"],
)
_UP_TO_HEADER_STAMP_SEC, _UP_TO_STATUS_STATUS, _UP_TO_LATITUDE, _REST = _CDR.constants
_PACK = _CDR.layout.pack


class GpsGpsFixFeed(Feed[board_pb2.Gps, sensor_msgs.NavSatFix]):
    """Gps to sensor_msgs/NavSatFix on the topic gps/fix."""

    route = Route(number=1, name="gps", topic="gps/fix", direction="board_to_ros")
    payload_type = board_pb2.Gps
    message_type = sensor_msgs.NavSatFix

    @staticmethod
    def to_ros(
        payload: board_pb2.Gps,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.NavSatFix:
        """The message that says what the payload says."""
        return sensor_msgs.NavSatFix(
            header=std_msgs.Header(stamp=stamp, frame_id="gps"),
            status=sensor_msgs.NavSatStatus(
                status=_QUALITY[payload.quality],
                service=1,
            ),
            latitude=payload.latitude_e7 / 10_000_000.0,
            longitude=payload.longitude_e7 / 10_000_000.0,
            altitude=payload.altitude_cm / 100.0,
            position_covariance_type=0,
        )

    @staticmethod
    def from_ros(message: sensor_msgs.NavSatFix) -> board_pb2.Gps:
        """The payload that says what the message says.

        It says nothing of health.
        """
        return board_pb2.Gps(
            quality=_QUALITY_BACK[message.status.status],
            latitude_e7=round(message.latitude * 10_000_000.0),
            longitude_e7=round(message.longitude * 10_000_000.0),
            altitude_cm=round(message.altitude * 100.0),
        )

    def pack(self, payload: board_pb2.Gps, stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(
            _UP_TO_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _UP_TO_STATUS_STATUS,
            _QUALITY[payload.quality],
            _UP_TO_LATITUDE,
            payload.latitude_e7 / 10_000_000.0,
            payload.longitude_e7 / 10_000_000.0,
            payload.altitude_cm / 100.0,
            _REST,
        )
