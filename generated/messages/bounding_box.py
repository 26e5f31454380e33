# Generated from mapping.yaml (BoundingBox); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/BoundingBox."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Message, UInt32


@dataclass(slots=True)
class BoundingBox(Message):
    """A rectangle in the image, in pixels; x and y are its top left corner."""

    __msgtype__: ClassVar[str] = "comms/msg/BoundingBox"
    __typehash__: ClassVar[str] = (
        "RIHS01_c68b8a3f3544faa176172ba3ff600d9bd69dfa1921133f9d6d5778f2b8790149"
    )

    x: UInt32 = 0
    y: UInt32 = 0
    width: UInt32 = 0
    height: UInt32 = 0
