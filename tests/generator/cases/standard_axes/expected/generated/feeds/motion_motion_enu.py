# Generated from mapping.yaml (row motion) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""motion (1): Motion to geometry_msgs/msg/AccelStamped on motion/enu."""

from __future__ import annotations

import math

from generated.interfaces import geometry_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed, single
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_DEG_TO_RAD = math.pi / 180
_CDR = cdr.template(
    geometry_msgs.AccelStamped(header=std_msgs.Header(frame_id="map")),
    ["header.stamp", "accel"],
)
_UP_TO_HEADER_STAMP_SEC, _UP_TO_ACCEL_LINEAR_X = _CDR.constants
_PACK = _CDR.layout.pack


class MotionMotionEnuFeed(Feed[board_pb2.Motion, geometry_msgs.AccelStamped]):
    """Motion to geometry_msgs/AccelStamped on the topic motion/enu."""

    route = Route(number=1, name="motion", topic="motion/enu", direction="board_to_ros")
    payload_type = board_pb2.Motion
    message_type = geometry_msgs.AccelStamped

    @staticmethod
    def to_ros(
        payload: board_pb2.Motion,
        stamp: Time = UNSTAMPED,
    ) -> geometry_msgs.AccelStamped:
        """The message that says what the payload says."""
        return geometry_msgs.AccelStamped(
            header=std_msgs.Header(stamp=stamp, frame_id="map"),
            accel=geometry_msgs.Accel(
                linear=geometry_msgs.Vector3(
                    x=payload.east,
                    y=payload.north,
                    z=-payload.down,
                ),
                angular=geometry_msgs.Vector3(
                    x=payload.roll * _DEG_TO_RAD,
                    y=payload.pitch * _DEG_TO_RAD,
                    z=(-payload.yaw - 90.0) * _DEG_TO_RAD,
                ),
            ),
        )

    @staticmethod
    def from_ros(message: geometry_msgs.AccelStamped) -> board_pb2.Motion:
        """The payload that says what the message says."""
        return board_pb2.Motion(
            east=message.accel.linear.x,
            north=message.accel.linear.y,
            down=-message.accel.linear.z,
            roll=single(message.accel.angular.x / _DEG_TO_RAD),
            pitch=single(message.accel.angular.y / _DEG_TO_RAD),
            yaw=single(-(message.accel.angular.z / _DEG_TO_RAD + 90.0)),
        )

    def pack(self, payload: board_pb2.Motion, stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(
            _UP_TO_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _UP_TO_ACCEL_LINEAR_X,
            payload.east,
            payload.north,
            -payload.down,
            payload.roll * _DEG_TO_RAD,
            payload.pitch * _DEG_TO_RAD,
            (-payload.yaw - 90.0) * _DEG_TO_RAD,
        )
