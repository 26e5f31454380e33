# Generated from mapping.yaml (BasestationRockMeasureRequest); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/BasestationRockMeasureRequest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Message, UInt32


@dataclass(slots=True)
class BasestationRockMeasureRequest(Message):
    """The line on the image, from (x1, y1) to (x2, y2) in pixels, along which a rock is to be measured."""

    __msgtype__: ClassVar[str] = "comms/msg/BasestationRockMeasureRequest"
    __typehash__: ClassVar[str] = (
        "RIHS01_9a265a25e1e0eb0132303efa521a0ceca729e2dd649cb81476730a563883d859"
    )

    x1: UInt32 = 0
    y1: UInt32 = 0
    x2: UInt32 = 0
    y2: UInt32 = 0
