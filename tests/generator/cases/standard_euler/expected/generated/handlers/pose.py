# Generated from mapping.yaml (row pose) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""pose (2): Pose from geometry_msgs/msg/Pose on pose."""

from __future__ import annotations

from generated.interfaces import geometry_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.convert import rotations
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(
    geometry_msgs.Pose(position=geometry_msgs.Point(z=0.0)),
    ["position.x", "position.y", "orientation"],
)
_UP_TO_POSITION_X, _UP_TO_ORIENTATION_X = _CDR.constants
_PACK = _CDR.layout.pack


class PoseHandler(Feed[board_pb2.Pose, geometry_msgs.Pose]):
    """Pose from geometry_msgs/Pose on the topic pose."""

    route = Route(number=2, name="pose", topic="pose", direction="ros_to_board")
    payload_type = board_pb2.Pose
    message_type = geometry_msgs.Pose

    @staticmethod
    def to_ros(payload: board_pb2.Pose, _stamp: Time = UNSTAMPED) -> geometry_msgs.Pose:
        """The message that says what the payload says."""
        return geometry_msgs.Pose(
            position=geometry_msgs.Point(
                x=payload.x_mm / 1_000.0,
                y=payload.y_mm / 1_000.0,
                z=0.0,
            ),
            orientation=geometry_msgs.Quaternion(
                *rotations.quaternion(0.0, 0.0, payload.yaw),
            ),
        )

    @staticmethod
    def from_ros(message: geometry_msgs.Pose) -> board_pb2.Pose:
        """The payload that says what the message says."""
        _roll2, _pitch2, yaw2 = rotations.angles(message.orientation)
        return board_pb2.Pose(
            x_mm=round(message.position.x * 1_000.0),
            y_mm=round(message.position.y * 1_000.0),
            yaw=yaw2,
        )

    def pack(self, payload: board_pb2.Pose, _stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        x, y, z, w = rotations.quaternion(0.0, 0.0, payload.yaw)
        return _PACK(
            _UP_TO_POSITION_X,
            payload.x_mm / 1_000.0,
            payload.y_mm / 1_000.0,
            _UP_TO_ORIENTATION_X,
            x,
            y,
            z,
            w,
        )
