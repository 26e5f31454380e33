"""Messages of the ROS 2 package rosgraph_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import builtin_interfaces


@dataclass(slots=True)
class Clock(Message):
    """ROS 2 message rosgraph_msgs/msg/Clock: the time of nodes with the parameter ``use_sim_time``."""

    __msgtype__: ClassVar[str] = "rosgraph_msgs/msg/Clock"
    __typehash__: ClassVar[str] = "RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564"

    clock: builtin_interfaces.Time = dataclasses.field(default_factory=builtin_interfaces.Time)
