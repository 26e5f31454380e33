# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Messages of the ROS 2 package geometry_msgs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from runtime.messages import Float64, Message


@dataclass(slots=True)
class Quaternion(Message):
    """geometry_msgs/msg/Quaternion."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Quaternion"

    x: Float64 = 0.0
    y: Float64 = 0.0
    z: Float64 = 0.0
    w: Float64 = 1.0


@dataclass(slots=True)
class Vector3(Message):
    """geometry_msgs/msg/Vector3."""

    __msgtype__: ClassVar[str] = "geometry_msgs/msg/Vector3"

    x: Float64 = 0.0
    y: Float64 = 0.0
    z: Float64 = 0.0
