# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The messages of the ROS 2 package rover."""

from __future__ import annotations

from my_rover.generated.messages.note import Note
from my_rover.generated.messages.note_detail import NoteDetail
from my_rover.generated.messages.part import Part

__all__ = [
    "Note",
    "NoteDetail",
    "Part",
]
