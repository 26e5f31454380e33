# Generated from mapping.yaml (SensorState); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/SensorState."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Message, UInt8


@dataclass(slots=True)
class SensorState(Message):
    """Activity of a sensor; shared by all sensors."""

    __msgtype__: ClassVar[str] = "comms/msg/SensorState"
    __typehash__: ClassVar[str] = (
        "RIHS01_6bc1bb0a38f2a73f4bcecda950ad09793d9df8965f59291ac8c8da9bf19ad3cb"
    )

    # Values of state
    SENSOR_IDLE: ClassVar[int] = 0
    SENSOR_OPERATING: ClassVar[int] = 1
    SENSOR_CALIBRATING: ClassVar[int] = 2
    SENSOR_ERROR: ClassVar[int] = 3

    state: UInt8 = 0
