# Generated from mapping.yaml (Packet.content); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/PacketContent."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.gps import Gps
from generated.messages.gps2 import Gps2
from generated.messages.imu import IMU as IMU_
from roverlink.runtime.core.messages import Message, UInt8


@dataclass(slots=True)
class PacketContent(Message):
    """Made from Packet.content."""

    __msgtype__: ClassVar[str] = "rover/msg/PacketContent"
    __typehash__: ClassVar[str] = (
        "RIHS01_c485ea4526c07d0372af6f489c03475c42020f90f25d841eaef01c85f341f18f"
    )

    NONE: ClassVar[int] = 0
    IMU: ClassVar[int] = 1
    GPS: ClassVar[int] = 2
    GPS2: ClassVar[int] = 3

    which: UInt8 = 0
    """Which of them it holds."""

    imu: IMU_ = dataclasses.field(default_factory=IMU_)
    gps: Gps = dataclasses.field(default_factory=Gps)
    gps2: Gps2 = dataclasses.field(default_factory=Gps2)
