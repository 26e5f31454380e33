# Generated from mapping.yaml (row motion) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""motion (1): Motion to geometry_msgs/msg/Vector3Stamped on motion/vector."""

from __future__ import annotations

from generated.interfaces import geometry_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(
    geometry_msgs.Vector3Stamped(header=std_msgs.Header(frame_id="map")),
    ["header.stamp", "vector"],
)
_UP_TO_HEADER_STAMP_SEC, _UP_TO_VECTOR_X = _CDR.constants
_PACK = _CDR.layout.pack


class MotionMotionVectorFeed(Feed[board_pb2.Motion, geometry_msgs.Vector3Stamped]):
    """Motion to geometry_msgs/Vector3Stamped on the topic motion/vector."""

    route = Route(
        number=1,
        name="motion",
        topic="motion/vector",
        direction="board_to_ros",
    )
    payload_type = board_pb2.Motion
    message_type = geometry_msgs.Vector3Stamped

    @staticmethod
    def to_ros(
        payload: board_pb2.Motion,
        stamp: Time = UNSTAMPED,
    ) -> geometry_msgs.Vector3Stamped:
        """The message that says what the payload says."""
        return geometry_msgs.Vector3Stamped(
            header=std_msgs.Header(stamp=stamp, frame_id="map"),
            vector=geometry_msgs.Vector3(
                x=payload.down,
                y=-payload.north,
                z=payload.east,
            ),
        )

    @staticmethod
    def from_ros(message: geometry_msgs.Vector3Stamped) -> board_pb2.Motion:
        """The payload that says what the message says.

        It says nothing of roll, pitch, yaw.
        """
        return board_pb2.Motion(
            down=message.vector.x,
            north=-message.vector.y,
            east=message.vector.z,
        )

    def pack(self, payload: board_pb2.Motion, stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(
            _UP_TO_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _UP_TO_VECTOR_X,
            payload.down,
            -payload.north,
            payload.east,
        )
