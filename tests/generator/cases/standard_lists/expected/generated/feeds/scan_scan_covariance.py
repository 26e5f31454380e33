# Generated from mapping.yaml (row scan) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""scan (1): Scan to sensor_msgs/msg/MagneticField on scan/covariance."""

from __future__ import annotations

from generated.interfaces import geometry_msgs, sensor_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed, single
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(
    sensor_msgs.MagneticField(
        header=std_msgs.Header(frame_id="base"),
        magnetic_field=geometry_msgs.Vector3(x=0.0, y=0.0, z=1e-05),
    ),
    ["header.stamp", "magnetic_field_covariance"],
)
_UP_TO_HEADER_STAMP_SEC, _UP_TO_MAGNETIC_FIELD_COVARIANCE = _CDR.constants
_PACK = _CDR.layout.pack


class ScanScanCovarianceFeed(Feed[board_pb2.Scan, sensor_msgs.MagneticField]):
    """Scan to sensor_msgs/MagneticField on the topic scan/covariance."""

    route = Route(
        number=1,
        name="scan",
        topic="scan/covariance",
        direction="board_to_ros",
    )
    payload_type = board_pb2.Scan
    message_type = sensor_msgs.MagneticField

    @staticmethod
    def to_ros(
        payload: board_pb2.Scan,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.MagneticField:
        """The message that says what the payload says."""
        return sensor_msgs.MagneticField(
            header=std_msgs.Header(stamp=stamp, frame_id="base"),
            magnetic_field=geometry_msgs.Vector3(x=0.0, y=0.0, z=1e-05),
            magnetic_field_covariance=[
                item / 1_000_000_000_000.0 for item in payload.strengths
            ],
        )

    @staticmethod
    def from_ros(message: sensor_msgs.MagneticField) -> board_pb2.Scan:
        """The payload that says what the message says.

        It says nothing of step, ranges_mm, format, raw, ok.
        """
        return board_pb2.Scan(
            strengths=[
                single(item * 1_000_000_000_000.0)
                for item in message.magnetic_field_covariance
            ],
        )

    def pack(self, payload: board_pb2.Scan, stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(
            _UP_TO_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _UP_TO_MAGNETIC_FIELD_COVARIANCE,
            *[item / 1_000_000_000_000.0 for item in payload.strengths],
        )
