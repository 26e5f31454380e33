# Generated from mapping.yaml (row moment) and moment.proto; do not edit.
# Regenerate with: roverlink generate
"""moment (1): Moment to rover/msg/Moment on moment."""

from __future__ import annotations

from google.protobuf import empty_pb2, wrappers_pb2

from generated.messages import Moment
from generated.pb2 import moment_pb2
from roverlink.runtime.convert.well_known import duration, timestamp
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(Moment)


class MomentHandler(Handler[moment_pb2.Moment, Moment]):
    """Moment to the topic moment."""

    route = Route(number=1, name="moment", topic="moment", direction="board_to_ros")
    payload_type = moment_pb2.Moment
    message_type = Moment

    @staticmethod
    def to_ros(payload: moment_pb2.Moment) -> Moment:
        """The message that says what the payload says."""
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
        """The payload that says what the message says."""
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

    def pack(self, payload: moment_pb2.Moment) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(
            cdr.LITTLE_ENDIAN,
            *timestamp.parts(payload.stamp, "stamp"),
            payload.HasField("seen"),
            *timestamp.parts(payload.seen, "seen"),
            *duration.parts(payload.took, "took"),
            payload.HasField("left"),
            *duration.parts(payload.left, "left"),
            payload.HasField("calibrated"),
            payload.HasField("level"),
            payload.level.value,
        )
