# Generated from mapping.yaml (DrivingBoardDiagnostics); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/DrivingBoardDiagnostics."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.motor_information import MotorInformation
from roverlink.runtime.core.messages import Message, UInt8


@dataclass(slots=True)
class DrivingBoardDiagnostics(Message):
    """State of the driving board and of each wheel and steering motor."""

    __msgtype__: ClassVar[str] = "comms/msg/DrivingBoardDiagnostics"
    __typehash__: ClassVar[str] = (
        "RIHS01_dc6f17c336850c756e46fb93f9cd8d51d27125bbdea1c4ec8402404b60113ac3"
    )

    # Values of state
    IDLE: ClassVar[int] = 0
    OPERATING: ClassVar[int] = 1
    CALIBRATING: ClassVar[int] = 2
    ERROR: ClassVar[int] = 3

    state: UInt8 = 0
    front_left_motor: MotorInformation = dataclasses.field(
        default_factory=MotorInformation
    )
    middle_left_motor: MotorInformation = dataclasses.field(
        default_factory=MotorInformation
    )
    back_left_motor: MotorInformation = dataclasses.field(
        default_factory=MotorInformation
    )
    front_right_motor: MotorInformation = dataclasses.field(
        default_factory=MotorInformation
    )
    middle_right_motor: MotorInformation = dataclasses.field(
        default_factory=MotorInformation
    )
    back_right_motor: MotorInformation = dataclasses.field(
        default_factory=MotorInformation
    )
    steering_front_left_motor: MotorInformation = dataclasses.field(
        default_factory=MotorInformation
    )
    steering_back_left_motor: MotorInformation = dataclasses.field(
        default_factory=MotorInformation
    )
    steering_front_right_motor: MotorInformation = dataclasses.field(
        default_factory=MotorInformation
    )
    steering_back_right_motor: MotorInformation = dataclasses.field(
        default_factory=MotorInformation
    )
