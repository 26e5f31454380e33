# Generated from mapping.yaml (Colliding); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Colliding."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Message, UInt8


@dataclass(slots=True)
class Colliding(Message):
    """Made from Colliding."""

    __msgtype__: ClassVar[str] = "rover/msg/Colliding"
    __typehash__: ClassVar[str] = (
        "RIHS01_4cf616a8fbc8fc825b251216c6bd475c36faf0f442f60cd52fab8dbb5d812bd3"
    )

    STATE_IDLE: ClassVar[int] = 0
    STATE_LOST: ClassVar[int] = 1
    LEFT_STATE_IDLE: ClassVar[int] = 0
    LEFT_STATE_BUSY: ClassVar[int] = 1
    LEFT: ClassVar[int] = 0
    RIGHT: ClassVar[int] = 1

    state: UInt8 = 0
    left_state: UInt8 = 0
    side: UInt8 = 0
    before: UInt8 = 0
