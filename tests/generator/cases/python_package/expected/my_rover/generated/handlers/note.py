# Generated from mapping.yaml (row note) and note.proto; do not edit.
# Regenerate with: roverlink generate
"""note (1): Note to rover/msg/Note on note."""

from __future__ import annotations

from my_rover.generated.conversions import note_detail, part
from my_rover.generated.messages import Note
from my_rover.generated.pb2 import note_pb2
from roverlink.runtime.core.handler import Handler, Route


class NoteHandler(Handler[note_pb2.Note, Note]):
    """Note to the topic note."""

    route = Route(number=1, name="note", topic="note", direction="board_to_ros")
    payload_type = note_pb2.Note
    message_type = Note

    @staticmethod
    def to_ros(payload: note_pb2.Note) -> Note:
        """The message that says what the payload says."""
        return Note(
            detail=note_detail.to_ros(payload.detail),
            parts=[part.to_ros(item) for item in payload.parts],
            height=payload.height,
        )

    @staticmethod
    def from_ros(message: Note) -> note_pb2.Note:
        """The payload that says what the message says."""
        return note_pb2.Note(
            detail=note_detail.from_ros(message.detail),
            parts=[part.from_ros(item) for item in message.parts],
            height=message.height,
        )
