# Generated from mapping.yaml (row attitude) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""attitude (1): Attitude to geometry_msgs/msg/QuaternionStamped on attitude."""

from __future__ import annotations

import math

from generated.interfaces import geometry_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.convert import rotations
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed, single
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_DEG_TO_RAD = math.pi / 180
_CDR = cdr.template(
    geometry_msgs.QuaternionStamped(header=std_msgs.Header(frame_id="map")),
    ["header.stamp", "quaternion"],
)
_UP_TO_HEADER_STAMP_SEC, _UP_TO_QUATERNION_X = _CDR.constants
_PACK = _CDR.layout.pack


class AttitudeHandler(Feed[board_pb2.Attitude, geometry_msgs.QuaternionStamped]):
    """Attitude to geometry_msgs/QuaternionStamped on the topic attitude."""

    route = Route(number=1, name="attitude", topic="attitude", direction="board_to_ros")
    payload_type = board_pb2.Attitude
    message_type = geometry_msgs.QuaternionStamped

    @staticmethod
    def to_ros(
        payload: board_pb2.Attitude,
        stamp: Time = UNSTAMPED,
    ) -> geometry_msgs.QuaternionStamped:
        """The message that says what the payload says."""
        return geometry_msgs.QuaternionStamped(
            header=std_msgs.Header(stamp=stamp, frame_id="map"),
            quaternion=geometry_msgs.Quaternion(
                *rotations.quaternion(
                    payload.roll * _DEG_TO_RAD,
                    -payload.pitch * _DEG_TO_RAD,
                    (-payload.heading + 90.0) * _DEG_TO_RAD,
                ),
            ),
        )

    @staticmethod
    def from_ros(message: geometry_msgs.QuaternionStamped) -> board_pb2.Attitude:
        """The payload that says what the message says."""
        roll, pitch, yaw = rotations.angles(message.quaternion)
        return board_pb2.Attitude(
            roll=single(roll / _DEG_TO_RAD),
            pitch=single(-pitch / _DEG_TO_RAD),
            heading=single(-(yaw / _DEG_TO_RAD - 90.0)),
        )

    def pack(self, payload: board_pb2.Attitude, stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        x, y, z, w = rotations.quaternion(
            payload.roll * _DEG_TO_RAD,
            -payload.pitch * _DEG_TO_RAD,
            (-payload.heading + 90.0) * _DEG_TO_RAD,
        )
        return _PACK(
            _UP_TO_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _UP_TO_QUATERNION_X,
            x,
            y,
            z,
            w,
        )
