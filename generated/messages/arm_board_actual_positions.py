# Generated from mapping.yaml (ArmBoardActualPositions); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/ArmBoardActualPositions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Bool, Float32, Message


@dataclass(slots=True)
class ArmBoardActualPositions(Message):
    """Positions of the arm's joints."""

    __msgtype__: ClassVar[str] = "comms/msg/ArmBoardActualPositions"
    __typehash__: ClassVar[str] = (
        "RIHS01_febf1447b0a5936f2574ce8d4dbec75686753aed1bc4504606cf675d579c201a"
    )

    jaw_open: Bool = False
    jaw_actual_position: Float32 = 0.0
    base_actual_position: Float32 = 0.0
    stepper_top_actual_position: Float32 = 0.0
    stepper_bottom_actual_position: Float32 = 0.0
    gripper_rotation_actual_position: Float32 = 0.0
    gripper_pitch_actual_position: Float32 = 0.0
