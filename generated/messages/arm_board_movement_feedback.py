# Generated from mapping.yaml (ArmBoardMovementFeedback); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/ArmBoardMovementFeedback."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Message, UInt8


@dataclass(slots=True)
class ArmBoardMovementFeedback(Message):
    """Outcome of the last commanded arm movement."""

    __msgtype__: ClassVar[str] = "comms/msg/ArmBoardMovementFeedback"
    __typehash__: ClassVar[str] = (
        "RIHS01_fa352b2e664e339058288b7f895a762aced05bc8699f7d5ee87520f1b3fa0ef5"
    )

    # Values of arm_error
    POINT_NOT_IN_RANGE: ClassVar[int] = 0
    OBSTRUCTION: ClassVar[int] = 1
    CALIBRATION: ClassVar[int] = 2
    MOTOR_MALFUNCTION: ClassVar[int] = 3
    ALL_OK: ClassVar[int] = 4

    arm_error: UInt8 = 0
