"""Messages of the ROS 2 package diagnostic_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Byte, Message
from roverlink.runtime.interfaces import std_msgs


@dataclass(slots=True)
class KeyValue(Message):
    """ROS 2 message diagnostic_msgs/msg/KeyValue."""

    __msgtype__: ClassVar[str] = "diagnostic_msgs/msg/KeyValue"

    key: str = ""
    value: str = ""


@dataclass(slots=True)
class DiagnosticStatus(Message):
    """ROS 2 message diagnostic_msgs/msg/DiagnosticStatus: the state of one component."""

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
    """ROS 2 message diagnostic_msgs/msg/DiagnosticArray."""

    __msgtype__: ClassVar[str] = "diagnostic_msgs/msg/DiagnosticArray"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    status: list[DiagnosticStatus] = dataclasses.field(default_factory=list)
