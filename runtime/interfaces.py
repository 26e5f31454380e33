"""Messages of ROS 2's own packages that generated messages hold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from runtime.messages import Int32, Message, UInt32


@dataclass(slots=True)
class Time(Message):
    """A point in time: seconds since 1970, and what is to be added to them."""

    __msgtype__: ClassVar[str] = "builtin_interfaces/msg/Time"

    sec: Int32 = 0
    nanosec: UInt32 = 0


@dataclass(slots=True)
class Duration(Message):
    """A span of time: seconds, rounded down, and what is to be added to them."""

    __msgtype__: ClassVar[str] = "builtin_interfaces/msg/Duration"

    sec: Int32 = 0
    nanosec: UInt32 = 0
