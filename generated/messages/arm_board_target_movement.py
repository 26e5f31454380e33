# Generated from mapping.yaml (ArmBoardTargetMovement); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/ArmBoardTargetMovement."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Bool, Float32, Message


@dataclass(slots=True)
class ArmBoardTargetMovement(Message):
    """A pose that the arm is to reach by itself."""

    __msgtype__: ClassVar[str] = "comms/msg/ArmBoardTargetMovement"
    __typehash__: ClassVar[str] = (
        "RIHS01_836b14fcc1dbe6c7fa99cbcc97b99f38d6e5294008a80a33b5976d611d1140a8"
    )

    target_x: Float32 = 0.0
    target_y: Float32 = 0.0
    target_z: Float32 = 0.0
    rotation_angle: Float32 = 0.0
    open_jaw: Bool = False
    final_gripper_angle: Float32 = 0.0
