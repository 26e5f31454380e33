# Generated from mapping.yaml (ArmBoardControlSignals); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/ArmBoardControlSignals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Bool, Float32, Message


@dataclass(slots=True)
class ArmBoardControlSignals(Message):
    """Direct control of the arm: one signal an actuator, as an operator drives it by hand."""

    __msgtype__: ClassVar[str] = "comms/msg/ArmBoardControlSignals"
    __typehash__: ClassVar[str] = (
        "RIHS01_563834da43b1e94f28ea327bf8c4efb82579cc62a127d556f307a91eebdb8145"
    )

    control_gripper_rotation: Float32 = 0.0
    control_gripper_pitch: Float32 = 0.0
    control_base: Float32 = 0.0
    control_jaw: Float32 = 0.0
    stepper_top_ena: Bool = False
    stepper_top_rev: Bool = False
    stepper_bottom_ena: Bool = False
    stepper_bottom_rev: Bool = False
