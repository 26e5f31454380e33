# Generated from mapping.yaml (Joints); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Joints."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.health_code import HealthCode
from roverlink.runtime.core.messages import Int8, Message, UInt16


@dataclass(slots=True)
class Joints(Message):
    """Made from Joints."""

    __msgtype__: ClassVar[str] = "rover/msg/Joints"
    __typehash__: ClassVar[str] = (
        "RIHS01_7b013883f54da4e32144189ff072a9075e1811fd52fe38e2ce89f4a74c698333"
    )

    SMALL_ZERO: ClassVar[int] = 0
    SMALL_MOST: ClassVar[int] = 255
    MEDIUM_ZERO: ClassVar[int] = 0
    MEDIUM_MOST: ClassVar[int] = 65535
    SIGNED_ZERO: ClassVar[int] = 0
    SIGNED_LEAST: ClassVar[int] = -128

    small: bytes = b""
    medium: list[UInt16] = dataclasses.field(default_factory=list)
    signed_field: list[Int8] = dataclasses.field(default_factory=list)
    codes: list[HealthCode] = dataclasses.field(default_factory=list)
