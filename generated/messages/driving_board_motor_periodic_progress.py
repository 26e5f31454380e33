# Generated from mapping.yaml (DrivingBoardMotorPeriodicProgress); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/DrivingBoardMotorPeriodicProgress."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Float32, Message


@dataclass(slots=True)
class DrivingBoardMotorPeriodicProgress(Message):
    """Distance left on the current drive command."""

    __msgtype__: ClassVar[str] = "comms/msg/DrivingBoardMotorPeriodicProgress"
    __typehash__: ClassVar[str] = (
        "RIHS01_59e6d07cfaafd0e930fd773d6d7224a38d00c207e093ea9a107e14edf8eef835"
    )

    distance_left: Float32 = 0.0
    """Along its arc; negative: backwards; 0: the rover stands [m]."""
