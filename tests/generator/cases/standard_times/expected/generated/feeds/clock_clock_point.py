# Generated from mapping.yaml (row clock) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""clock (1): Clock to trajectory_msgs/msg/JointTrajectoryPoint on clock/point."""

from __future__ import annotations

from generated.interfaces import trajectory_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed, nanoseconds
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Duration, Time

_CDR = cdr.template(
    trajectory_msgs.JointTrajectoryPoint(
        positions=[],
        velocities=[],
        accelerations=[],
        effort=[1.5],
    ),
    ["time_from_start"],
)
(_UP_TO_TIME_FROM_START_SEC,) = _CDR.constants
_PACK = _CDR.layout.pack


class ClockClockPointFeed(Feed[board_pb2.Clock, trajectory_msgs.JointTrajectoryPoint]):
    """Clock to trajectory_msgs/JointTrajectoryPoint on the topic clock/point."""

    route = Route(number=1, name="clock", topic="clock/point", direction="board_to_ros")
    payload_type = board_pb2.Clock
    message_type = trajectory_msgs.JointTrajectoryPoint

    @staticmethod
    def to_ros(
        payload: board_pb2.Clock,
        _stamp: Time = UNSTAMPED,
    ) -> trajectory_msgs.JointTrajectoryPoint:
        """The message that says what the payload says."""
        return trajectory_msgs.JointTrajectoryPoint(
            positions=[],
            velocities=[],
            accelerations=[],
            effort=[1.5],
            time_from_start=Duration(*divmod(payload.span_us * 1_000, 1_000_000_000)),
        )

    @staticmethod
    def from_ros(message: trajectory_msgs.JointTrajectoryPoint) -> board_pb2.Clock:
        """The payload that says what the message says.

        It says nothing of uptime, utc_ms, utc_ns, seconds.
        """
        return board_pb2.Clock(span_us=nanoseconds(message.time_from_start) // 1_000)

    def pack(self, payload: board_pb2.Clock, _stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        sec, nanosec = divmod(payload.span_us * 1_000, 1_000_000_000)
        return _PACK(_UP_TO_TIME_FROM_START_SEC, sec, nanosec)
