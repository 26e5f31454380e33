# Generated from mapping.yaml (Note.detail); do not edit.
# Regenerate with: roverlink generate
"""Note.detail to and from rover/msg/NoteDetail."""

from __future__ import annotations

from google.protobuf import any_pb2

from my_rover.generated.conversions import part
from my_rover.generated.messages import NoteDetail
from my_rover.generated.pb2 import note_pb2
from roverlink.runtime.convert.any_of import (
    check_empty,
    check_none,
    holds,
    packed,
    unpacked,
)


def to_ros(payload: any_pb2.Any) -> NoteDetail:
    """The message that says what the payload says."""
    if holds(payload, note_pb2.Part):
        return NoteDetail(
            which=NoteDetail.PART,
            part=part.to_ros(unpacked(payload, note_pb2.Part, "NoteDetail.part")),
        )
    check_empty(payload, "NoteDetail")
    return NoteDetail()


def from_ros(message: NoteDetail) -> any_pb2.Any:
    """The payload that says what the message says."""
    if message.which == NoteDetail.PART:
        return packed(part.from_ros(message.part))
    check_none(message.which, "NoteDetail")
    return any_pb2.Any()
