# Generated from mapping.yaml (Waypoint); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Waypoint."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.arm import Arm
from generated.messages.gps import GPS
from generated.messages.imu import IMU
from roverlink.runtime.core.messages import Float64, Message


@dataclass(slots=True)
class Waypoint(Message):
    """Made from Waypoint."""

    __msgtype__: ClassVar[str] = "rover/msg/Waypoint"
    __typehash__: ClassVar[str] = (
        "RIHS01_8ad09dd7eab7146e966712beed9dad3f72168e6340560d53c38c3d5715b8ba0c"
    )

    x: Float64 = 0.0
    imu: IMU = dataclasses.field(default_factory=IMU)
    gps: GPS = dataclasses.field(default_factory=GPS)
    arm: Arm = dataclasses.field(default_factory=Arm)
    l: Arm = dataclasses.field(default_factory=Arm)  # noqa: E741  # as in the .proto
