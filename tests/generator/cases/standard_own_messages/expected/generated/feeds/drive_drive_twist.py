# Generated from mapping.yaml (row drive) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""drive (3): Drive from geometry_msgs/msg/TwistStamped on drive/twist."""

from __future__ import annotations

from generated.interfaces import geometry_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed, single
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(
    geometry_msgs.TwistStamped(header=std_msgs.Header(frame_id="")),
    ["header.stamp", "twist.linear.x", "twist.angular.z"],
)
_UP_TO_HEADER_STAMP_SEC, _UP_TO_TWIST_LINEAR_X, _UP_TO_TWIST_ANGULAR_Z = _CDR.constants
_PACK = _CDR.layout.pack


class DriveDriveTwistFeed(Feed[board_pb2.Drive, geometry_msgs.TwistStamped]):
    """Drive from geometry_msgs/TwistStamped on the topic drive/twist."""

    route = Route(number=3, name="drive", topic="drive/twist", direction="ros_to_board")
    payload_type = board_pb2.Drive
    message_type = geometry_msgs.TwistStamped

    @staticmethod
    def to_ros(
        payload: board_pb2.Drive,
        stamp: Time = UNSTAMPED,
    ) -> geometry_msgs.TwistStamped:
        """The message that says what the payload says."""
        return geometry_msgs.TwistStamped(
            header=std_msgs.Header(stamp=stamp, frame_id=""),
            twist=geometry_msgs.Twist(
                linear=geometry_msgs.Vector3(x=payload.velocity.forward),
                angular=geometry_msgs.Vector3(z=payload.velocity.turn),
            ),
        )

    @staticmethod
    def from_ros(message: geometry_msgs.TwistStamped) -> board_pb2.Drive:
        """The payload that says what the message says."""
        return board_pb2.Drive(
            velocity={
                "forward": single(message.twist.linear.x),
                "turn": single(message.twist.angular.z),
            },
        )

    def pack(self, payload: board_pb2.Drive, stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(
            _UP_TO_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _UP_TO_TWIST_LINEAR_X,
            payload.velocity.forward,
            _UP_TO_TWIST_ANGULAR_Z,
            payload.velocity.turn,
        )
