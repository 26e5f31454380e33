# Generated from mapping.yaml (BasestationRoverLocalization); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/BasestationRoverLocalization."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Float32, Message


@dataclass(slots=True)
class BasestationRoverLocalization(Message):
    """Position of the rover on the field."""

    __msgtype__: ClassVar[str] = "comms/msg/BasestationRoverLocalization"
    __typehash__: ClassVar[str] = (
        "RIHS01_8e865d22f13eaf418f97770801449fea0752cc2b73be312ab5adff5d85e133f5"
    )

    x: Float32 = 0.0
    """Along the field's x axis [m]."""
    y: Float32 = 0.0
    """Along the field's y axis [m]."""
    z: Float32 = 0.0
    """Along the field's z axis [m]."""
