"""Messages of the ROS 2 package builtin_interfaces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Int32, Message, UInt32


@dataclass(slots=True)
class Time(Message):
    """ROS 2 message builtin_interfaces/msg/Time: seconds since 1970, plus nanoseconds."""

    __msgtype__: ClassVar[str] = "builtin_interfaces/msg/Time"

    sec: Int32 = 0
    nanosec: UInt32 = 0

    @classmethod
    def since_1970(cls, nanoseconds: int) -> Time:
        """Return the time that is a number of nanoseconds after the start of 1970, for the stamp of a message.

        The seconds of ROS 2 end in 2038. A later time, such as that of a clock that is set wrong, is the last second.
        """
        seconds, rest = divmod(nanoseconds, 1_000_000_000)
        return cls(max(-(2**31), min(seconds, 2**31 - 1)), rest)


@dataclass(slots=True)
class Duration(Message):
    """ROS 2 message builtin_interfaces/msg/Duration: seconds, and nanoseconds that are added to them.

    The seconds of a negative duration are rounded down: -0.5 s is -1 s and 500,000,000 ns.
    """

    __msgtype__: ClassVar[str] = "builtin_interfaces/msg/Duration"

    sec: Int32 = 0
    nanosec: UInt32 = 0
