# Generated from mapping.yaml (ArmBoardDiagnostics); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/ArmBoardDiagnostics."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.motor_information import MotorInformation
from roverlink.runtime.core.messages import Message, UInt8


@dataclass(slots=True)
class ArmBoardDiagnostics(Message):
    """State of the arm board and of each of its motors."""

    __msgtype__: ClassVar[str] = "comms/msg/ArmBoardDiagnostics"
    __typehash__: ClassVar[str] = (
        "RIHS01_814b32e2265d84961c292f85c65f1534783cd572ef75be4d311f7ea8b1b24c62"
    )

    # Values of state
    IDLE: ClassVar[int] = 0
    OPERATING: ClassVar[int] = 1
    CALIBRATING: ClassVar[int] = 2
    ERROR: ClassVar[int] = 3

    gripper_rotation_motor: MotorInformation = dataclasses.field(
        default_factory=MotorInformation
    )
    gripper_pitch_motor: MotorInformation = dataclasses.field(
        default_factory=MotorInformation
    )
    base_motor: MotorInformation = dataclasses.field(default_factory=MotorInformation)
    top_motor: MotorInformation = dataclasses.field(default_factory=MotorInformation)
    bottom_motor: MotorInformation = dataclasses.field(default_factory=MotorInformation)
    jaw_motor: MotorInformation = dataclasses.field(default_factory=MotorInformation)
    state: UInt8 = 0
