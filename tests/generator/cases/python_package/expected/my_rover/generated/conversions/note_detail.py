# Generated from mapping.yaml (Note.detail); do not edit.
# Regenerate with: roverlink generate
"""Convert between Note.detail and rover/msg/NoteDetail."""

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
    """Convert the Any to rover/msg/NoteDetail."""
    if holds(payload, note_pb2.Part):
        return NoteDetail(
            which=NoteDetail.PART,
            part=part.to_ros(unpacked(payload, note_pb2.Part, "NoteDetail.part")),
        )
    check_empty(payload, "NoteDetail")
    return NoteDetail()


def from_ros(message: NoteDetail) -> any_pb2.Any:
    """Convert rover/msg/NoteDetail to the Any."""
    if message.which == NoteDetail.PART:
        return packed(part.from_ros(message.part))
    check_none(message.which, "NoteDetail")
    return any_pb2.Any()
