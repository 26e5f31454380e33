# Generated from mapping.yaml (row drive) and all.proto; do not edit.
# Regenerate with: roverlink generate
"""drive (1): Drive from rover/msg/Drive on drive."""

from __future__ import annotations

from generated.messages import Drive
from generated.pb2 import all_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Deadman, Handler, Route

_CDR = cdr.fixed_layout(Drive)


class DriveHandler(Handler[all_pb2.Drive, Drive]):
    """Drive from the topic drive."""

    route = Route(
        number=1,
        name="drive",
        topic="drive",
        direction="ros_to_board",
        deadman=Deadman(after_ms=500, repeat_ms=1000, send={"speed": 0.0}),
        max_rate=50,
        priority=9,
    )
    payload_type = all_pb2.Drive
    message_type = Drive

    @staticmethod
    def to_ros(payload: all_pb2.Drive) -> Drive:
        """The message that says what the payload says."""
        return Drive(speed=payload.speed)

    @staticmethod
    def from_ros(message: Drive) -> all_pb2.Drive:
        """The payload that says what the message says."""
        return all_pb2.Drive(speed=message.speed)

    def pack(self, payload: all_pb2.Drive) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.speed)
