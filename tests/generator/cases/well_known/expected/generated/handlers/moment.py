# Generated from mapping.yaml (row moment) and moment.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row moment: Moment and rover/msg/Moment."""

from __future__ import annotations

from google.protobuf import empty_pb2, wrappers_pb2

from generated.messages import Moment
from generated.pb2 import moment_pb2
from roverlink.runtime.convert.well_known import duration, timestamp
from roverlink.runtime.core.handler import Handler, Route


class MomentHandler(Handler[moment_pb2.Moment, Moment]):
    """Moment as rover/msg/Moment.

    Number 1 of the envelope, board_to_ros, topic moment.
    """

    route = Route(
        number=1,
        name="moment",
        topic="moment",
        direction="board_to_ros",
    )
    payload_type = moment_pb2.Moment
    message_type = Moment

    @staticmethod
    def to_ros(payload: moment_pb2.Moment) -> Moment:
        """Convert Moment to rover/msg/Moment."""
        return Moment(
            stamp=timestamp.to_ros(payload.stamp, "stamp"),
            has_seen=payload.HasField("seen"),
            seen=timestamp.to_ros(payload.seen, "seen"),
            took=duration.to_ros(payload.took, "took"),
            has_left=payload.HasField("left"),
            left=duration.to_ros(payload.left, "left"),
            has_calibrated=payload.HasField("calibrated"),
            has_level=payload.HasField("level"),
            level=payload.level.value,
        )

    @staticmethod
    def from_ros(message: Moment) -> moment_pb2.Moment:
        """Convert rover/msg/Moment to Moment."""
        return moment_pb2.Moment(
            stamp=timestamp.from_ros(message.stamp, "stamp"),
            seen=timestamp.from_ros(message.seen, "seen") if message.has_seen else None,
            took=duration.from_ros(message.took, "took"),
            left=duration.from_ros(message.left, "left") if message.has_left else None,
            calibrated=empty_pb2.Empty() if message.has_calibrated else None,
            level=(
                wrappers_pb2.DoubleValue(value=message.level)
                if message.has_level
                else None
            ),
        )
