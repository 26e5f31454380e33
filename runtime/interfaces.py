"""Messages of ROS 2's common interfaces that the runtime itself speaks, or that generated messages hold.

They are written by hand: the rover needs no rosbags.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from runtime.messages import Byte, Int32, Message, UInt32


@dataclass(slots=True)
class Time(Message):
    """builtin_interfaces/msg/Time: seconds since 1970, and what is to be added to them."""

    __msgtype__: ClassVar[str] = "builtin_interfaces/msg/Time"

    sec: Int32 = 0
    nanosec: UInt32 = 0


@dataclass(slots=True)
class Duration(Message):
    """builtin_interfaces/msg/Duration: seconds, rounded down, and what is to be added to them."""

    __msgtype__: ClassVar[str] = "builtin_interfaces/msg/Duration"

    sec: Int32 = 0
    nanosec: UInt32 = 0


@dataclass(slots=True)
class Header(Message):
    """std_msgs/msg/Header."""

    __msgtype__: ClassVar[str] = "std_msgs/msg/Header"

    stamp: Time = dataclasses.field(default_factory=Time)
    frame_id: str = ""


@dataclass(slots=True)
class KeyValue(Message):
    """diagnostic_msgs/msg/KeyValue."""

    __msgtype__: ClassVar[str] = "diagnostic_msgs/msg/KeyValue"

    key: str = ""
    value: str = ""


@dataclass(slots=True)
class DiagnosticStatus(Message):
    """diagnostic_msgs/msg/DiagnosticStatus: how one thing is."""

    __msgtype__: ClassVar[str] = "diagnostic_msgs/msg/DiagnosticStatus"

    OK: ClassVar[int] = 0
    WARN: ClassVar[int] = 1
    ERROR: ClassVar[int] = 2
    STALE: ClassVar[int] = 3

    level: Byte = 0
    name: str = ""
    message: str = ""
    hardware_id: str = ""
    values: list[KeyValue] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class DiagnosticArray(Message):
    """diagnostic_msgs/msg/DiagnosticArray."""

    __msgtype__: ClassVar[str] = "diagnostic_msgs/msg/DiagnosticArray"

    header: Header = dataclasses.field(default_factory=Header)
    status: list[DiagnosticStatus] = dataclasses.field(default_factory=list)
