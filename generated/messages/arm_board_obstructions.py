# Generated from mapping.yaml (ArmBoardObstructions); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/ArmBoardObstructions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Float32, Message


@dataclass(slots=True)
class ArmBoardObstructions(Message):
    """Obstacles in the way of the arm."""

    __msgtype__: ClassVar[str] = "comms/msg/ArmBoardObstructions"
    __typehash__: ClassVar[str] = (
        "RIHS01_564e7fd09e92bde0bfaed2738d0a38243ac5b40034dec7cd967fd303df8b8c2d"
    )

    obstructions_list: Float32 = 0.0
