# Generated from mapping.yaml (row cmd_vel) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""cmd_vel (1): Velocity from geometry_msgs/msg/Twist on cmd_vel."""

from __future__ import annotations

import math

from generated.interfaces import geometry_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed, single
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_DEG_TO_RAD = math.pi / 180
_CDR = cdr.template(geometry_msgs.Twist(), ["linear.x", "angular.z"])
_UP_TO_LINEAR_X, _UP_TO_ANGULAR_Z = _CDR.constants
_PACK = _CDR.layout.pack


class CmdVelHandler(Feed[board_pb2.Velocity, geometry_msgs.Twist]):
    """Velocity from geometry_msgs/Twist on the topic cmd_vel."""

    route = Route(number=1, name="cmd_vel", topic="cmd_vel", direction="ros_to_board")
    payload_type = board_pb2.Velocity
    message_type = geometry_msgs.Twist

    @staticmethod
    def to_ros(
        payload: board_pb2.Velocity,
        _stamp: Time = UNSTAMPED,
    ) -> geometry_msgs.Twist:
        """The message that says what the payload says."""
        return geometry_msgs.Twist(
            linear=geometry_msgs.Vector3(x=payload.forward / 100.0),
            angular=geometry_msgs.Vector3(z=payload.turn * _DEG_TO_RAD),
        )

    @staticmethod
    def from_ros(message: geometry_msgs.Twist) -> board_pb2.Velocity:
        """The payload that says what the message says."""
        return board_pb2.Velocity(
            forward=single(message.linear.x * 100.0),
            turn=single(message.angular.z / _DEG_TO_RAD),
        )

    def pack(self, payload: board_pb2.Velocity, _stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(
            _UP_TO_LINEAR_X,
            payload.forward / 100.0,
            _UP_TO_ANGULAR_Z,
            payload.turn * _DEG_TO_RAD,
        )
