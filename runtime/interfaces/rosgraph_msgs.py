# Generated from the definitions of ROS 2; do not edit.
# Regenerate with: make generate
"""Messages of the ROS 2 package rosgraph_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import Time


@dataclass(slots=True)
class Clock(Message):
    """rosgraph_msgs/msg/Clock."""

    __msgtype__: ClassVar[str] = "rosgraph_msgs/msg/Clock"
    __typehash__: ClassVar[str] = "RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564"

    clock: Time = dataclasses.field(default_factory=Time)
