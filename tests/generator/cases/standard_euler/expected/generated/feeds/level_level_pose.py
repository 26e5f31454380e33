# Generated from mapping.yaml (row level) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""level (3): Level to geometry_msgs/msg/PoseStamped on level/pose."""

from __future__ import annotations

from generated.interfaces import geometry_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.convert import rotations
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed, single
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(
    geometry_msgs.PoseStamped(
        header=std_msgs.Header(frame_id="map"),
        pose=geometry_msgs.Pose(position=geometry_msgs.Point(x=0.0, y=0.0, z=0.0)),
    ),
    ["header.stamp", "pose.orientation"],
)
_UP_TO_HEADER_STAMP_SEC, _UP_TO_POSE_ORIENTATION_X = _CDR.constants
_PACK = _CDR.layout.pack


class LevelLevelPoseFeed(Feed[board_pb2.Level, geometry_msgs.PoseStamped]):
    """Level to geometry_msgs/PoseStamped on the topic level/pose."""

    route = Route(number=3, name="level", topic="level/pose", direction="board_to_ros")
    payload_type = board_pb2.Level
    message_type = geometry_msgs.PoseStamped

    @staticmethod
    def to_ros(
        payload: board_pb2.Level,
        stamp: Time = UNSTAMPED,
    ) -> geometry_msgs.PoseStamped:
        """The message that says what the payload says."""
        return geometry_msgs.PoseStamped(
            header=std_msgs.Header(stamp=stamp, frame_id="map"),
            pose=geometry_msgs.Pose(
                position=geometry_msgs.Point(x=0.0, y=0.0, z=0.0),
                orientation=geometry_msgs.Quaternion(
                    *rotations.quaternion(
                        payload.roll if payload.HasField("roll") else 0.5,
                        0.0,
                        0.0,
                    ),
                ),
            ),
        )

    @staticmethod
    def from_ros(message: geometry_msgs.PoseStamped) -> board_pb2.Level:
        """The payload that says what the message says."""
        roll, _pitch, _yaw = rotations.angles(message.pose.orientation)
        return board_pb2.Level(roll=single(roll))

    def pack(self, payload: board_pb2.Level, stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        x, y, z, w = rotations.quaternion(
            payload.roll if payload.HasField("roll") else 0.5,
            0.0,
            0.0,
        )
        return _PACK(
            _UP_TO_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _UP_TO_POSE_ORIENTATION_X,
            x,
            y,
            z,
            w,
        )
