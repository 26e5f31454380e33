# Generated from mapping.yaml (DrivingBoardMotorMessage); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/DrivingBoardMotorMessage."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Float32, Message


@dataclass(slots=True)
class DrivingBoardMotorMessage(Message):
    """Made from DrivingBoardMotorMessage.

    A drive command: how far to go, and along which arc. It replaces the one before, also in the middle of its arc.
    With a distance of 0, the radius has no meaning, and the wheels keep their direction.
    """

    __msgtype__: ClassVar[str] = "comms/msg/DrivingBoardMotorMessage"
    __typehash__: ClassVar[str] = (
        "RIHS01_2cd1ad69f278b92cf96676fc749456f4a630c4fd69430323d8463e4480774a40"
    )

    distance_to_go: Float32 = 0.0
    """Along the arc of the origin of base_link; negative: backwards; 0: stop [m]."""
    turning_radius: Float32 = 0.0
    """Positive: the centre of the arc is to the left (REP 103); 0: a straight line [m]."""
