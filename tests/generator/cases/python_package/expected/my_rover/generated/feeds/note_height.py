# Generated from mapping.yaml (row note) and note.proto; do not edit.
# Regenerate with: roverlink generate
"""note (1): Note to std_msgs/msg/Float64 on height."""

from __future__ import annotations

from my_rover.generated.interfaces import std_msgs
from my_rover.generated.pb2 import note_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_CDR = cdr.template(std_msgs.Float64_(), ["data"])
(_UP_TO_DATA,) = _CDR.constants
_PACK = _CDR.layout.pack


class NoteHeightFeed(Feed[note_pb2.Note, std_msgs.Float64_]):
    """Note to std_msgs/Float64 on the topic height."""

    route = Route(number=1, name="note", topic="height", direction="board_to_ros")
    payload_type = note_pb2.Note
    message_type = std_msgs.Float64_

    @staticmethod
    def to_ros(payload: note_pb2.Note, _stamp: Time = UNSTAMPED) -> std_msgs.Float64_:
        """The message that says what the payload says."""
        return std_msgs.Float64_(data=payload.height)

    @staticmethod
    def from_ros(message: std_msgs.Float64_) -> note_pb2.Note:
        """The payload that says what the message says."""
        return note_pb2.Note(height=message.data)

    def pack(self, payload: note_pb2.Note, _stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(_UP_TO_DATA, payload.height)
