# Generated from mapping.yaml (Mode); do not edit.
# Regenerate with: roverlink generate
"""rover/msg/GripperMode."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from runtime.messages import Message, UInt8


@dataclass(slots=True)
class GripperMode(Message):
    """Made from Mode."""

    __msgtype__: ClassVar[str] = "rover/msg/GripperMode"

    MODE_OPEN: ClassVar[int] = 0
    MODE_CLOSED: ClassVar[int] = 1

    mode: UInt8 = 0
