# Generated from mapping.yaml (Arm); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Arm."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.arm_segment import ArmSegment
from generated.messages.joint import Joint
from generated.messages.wrist import Wrist
from roverlink.runtime.core.messages import Message


@dataclass(slots=True)
class Arm(Message):
    """Made from Arm."""

    __msgtype__: ClassVar[str] = "rover/msg/Arm"
    __typehash__: ClassVar[str] = (
        "RIHS01_bb458ee7cd0846079ba20e67572d2c2ac0d6729116fe37a866dbd787cfabdcd8"
    )

    upper: ArmSegment = dataclasses.field(default_factory=ArmSegment)
    others: list[ArmSegment] = dataclasses.field(default_factory=list)
    elbow: Joint = dataclasses.field(default_factory=Joint)
    wrist: Wrist = dataclasses.field(default_factory=Wrist)
