# Generated from mapping.yaml (MotorInformation); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/MotorInformation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Float32, Int32, Message, UInt8


@dataclass(slots=True)
class MotorInformation(Message):
    """State and readings of one motor."""

    __msgtype__: ClassVar[str] = "comms/msg/MotorInformation"
    __typehash__: ClassVar[str] = (
        "RIHS01_7abc3b902a04a77a9684138df2acb76a8ede60c012dc4a535d42534beee7079d"
    )

    # Values of state
    IDLE: ClassVar[int] = 0
    OPERATING: ClassVar[int] = 1
    CALIBRATING: ClassVar[int] = 2
    ERROR: ClassVar[int] = 3

    state: UInt8 = 0
    motor_id: Int32 = 0
    rpm: Float32 = 0.0
    """Speed of rotation [rpm]."""
    voltage: Float32 = 0.0
    """Voltage [V]."""
    encoder_angle: Float32 = 0.0
