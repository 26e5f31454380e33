# Generated from mapping.yaml (BasestationDetectedObject); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/BasestationDetectedObject."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.bounding_box import BoundingBox
from roverlink.runtime.core.messages import Float32, Message, UInt8, UInt32


@dataclass(slots=True)
class BasestationDetectedObject(Message):
    """One object seen in one camera frame. A frame with N objects travels as N messages."""

    __msgtype__: ClassVar[str] = "comms/msg/BasestationDetectedObject"
    __typehash__: ClassVar[str] = (
        "RIHS01_b598698f6290b7898288e77113b6ad48fa7185fede25e6c8ad8aeaea58acb4b8"
    )

    # Values of type
    OBJECT_UNKNOWN: ClassVar[int] = 0
    OBJECT_ROCK: ClassVar[int] = 1
    OBJECT_REGOLITH: ClassVar[int] = 2
    OBJECT_MAIN_SWITCH: ClassVar[int] = 3
    OBJECT_SWITCH: ClassVar[int] = 5
    OBJECT_ROTARY_SWITCH: ClassVar[int] = 6
    OBJECT_ROTARY_POWER_SWITCH: ClassVar[int] = 4
    OBJECT_SOCKET: ClassVar[int] = 7
    OBJECT_ELECTROMAGNET: ClassVar[int] = 8
    OBJECT_PLATE: ClassVar[int] = 9
    OBJECT_CABLE: ClassVar[int] = 10

    frame_id: UInt32 = 0
    """Counts the camera frames."""
    total_count: UInt32 = 0
    """Objects in this frame."""
    index: UInt32 = 0
    """This object among them, from 0."""
    id: UInt32 = 0
    """Stays with an object from frame to frame."""
    type: UInt8 = 0
    bbox: BoundingBox = dataclasses.field(default_factory=BoundingBox)
    confidence: Float32 = 0.0
