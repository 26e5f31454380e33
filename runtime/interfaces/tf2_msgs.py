# Generated from the definitions of ROS 2; do not edit.
# Regenerate with: make generate
"""Messages of the ROS 2 package tf2_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import geometry_msgs


@dataclass(slots=True)
class TFMessage(Message):
    """tf2_msgs/msg/TFMessage."""

    __msgtype__: ClassVar[str] = "tf2_msgs/msg/TFMessage"
    __typehash__: ClassVar[str] = "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"

    transforms: list[geometry_msgs.TransformStamped] = dataclasses.field(default_factory=list)
