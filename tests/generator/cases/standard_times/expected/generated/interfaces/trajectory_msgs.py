# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Messages of the ROS 2 package trajectory_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Float64, Message
from roverlink.runtime.interfaces import Duration

__all__ = [
    "JointTrajectoryPoint",
]


@dataclass(slots=True)
class JointTrajectoryPoint(Message):
    """trajectory_msgs/msg/JointTrajectoryPoint."""

    __msgtype__: ClassVar[str] = "trajectory_msgs/msg/JointTrajectoryPoint"

    positions: list[Float64] = dataclasses.field(default_factory=list)
    velocities: list[Float64] = dataclasses.field(default_factory=list)
    accelerations: list[Float64] = dataclasses.field(default_factory=list)
    effort: list[Float64] = dataclasses.field(default_factory=list)
    time_from_start: Duration = dataclasses.field(default_factory=Duration)
