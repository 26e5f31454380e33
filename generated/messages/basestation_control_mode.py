# Generated from mapping.yaml (BasestationControlMode); do not edit.
# Regenerate with: roverlink generate
"""comms/msg/BasestationControlMode."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from runtime.messages import Message, UInt8


@dataclass(slots=True)
class BasestationControlMode(Message):
    """Who drives: the operator or the rover itself."""

    __msgtype__: ClassVar[str] = "comms/msg/BasestationControlMode"

    MODE_MANUAL: ClassVar[int] = 0
    MODE_AUTO: ClassVar[int] = 1

    mode: UInt8 = 0
