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


@dataclass(slots=True)
class String(Message):
    """ROS 2 message std_msgs/msg/String."""

    __msgtype__: ClassVar[str] = "std_msgs/msg/String"
    __typehash__: ClassVar[str] = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"

    data: str = ""
