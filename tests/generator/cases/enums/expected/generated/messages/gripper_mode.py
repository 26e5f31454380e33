# Generated from mapping.yaml (Mode); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/GripperMode."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Message, UInt8


@dataclass(slots=True)
class GripperMode(Message):
    """Made from Mode."""

    __msgtype__: ClassVar[str] = "rover/msg/GripperMode"
    __typehash__: ClassVar[str] = (
        "RIHS01_195b24b2351795cd144f2a6f1a07a0a5ff313bd39c5ff603c1584cde152898f3"
    )

    MODE_OPEN: ClassVar[int] = 0
    MODE_CLOSED: ClassVar[int] = 1

    mode: UInt8 = 0
