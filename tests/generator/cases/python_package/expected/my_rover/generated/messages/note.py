# Generated from mapping.yaml (Note); do not edit.
# Regenerate with: roverlink generate
"""rover/msg/Note."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from my_rover.generated.messages.note_detail import NoteDetail
from my_rover.generated.messages.part import Part
from roverlink.runtime.core.messages import Float64, Message


@dataclass(slots=True)
class Note(Message):
    """Made from Note."""

    __msgtype__: ClassVar[str] = "rover/msg/Note"
    __typehash__: ClassVar[str] = (
        "RIHS01_694a9e7ae2fbec7042848a32a0515cf0c27bc5deeeec6c3936a25f3e7532a6da"
    )

    detail: NoteDetail = dataclasses.field(default_factory=NoteDetail)
    parts: list[Part] = dataclasses.field(default_factory=list)
    height: Float64 = 0.0
