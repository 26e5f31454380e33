# Generated from mapping.yaml (BoundingBox); do not edit.
# Regenerate with: roverlink generate
"""comms/msg/BoundingBox."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from runtime.messages import Message, UInt32


@dataclass(slots=True)
class BoundingBox(Message):
    """A rectangle in the image, in pixels; x and y are its top left corner."""

    __msgtype__: ClassVar[str] = "comms/msg/BoundingBox"

    x: UInt32 = 0
    y: UInt32 = 0
    width: UInt32 = 0
    height: UInt32 = 0
