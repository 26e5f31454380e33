"""Messages of the ROS 2 package std_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import builtin_interfaces


@dataclass(slots=True)
class Header(Message):
    """ROS 2 message std_msgs/msg/Header."""

    __msgtype__: ClassVar[str] = "std_msgs/msg/Header"

    stamp: builtin_interfaces.Time = dataclasses.field(default_factory=builtin_interfaces.Time)
    frame_id: str = ""
