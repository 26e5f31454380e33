# Generated from the definitions of ROS 2; do not edit.
# Regenerate with: make generate
"""Messages of the ROS 2 package diagnostic_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Byte, Message
from roverlink.runtime.interfaces import std_msgs


@dataclass(slots=True)
class KeyValue(Message):
    """diagnostic_msgs/msg/KeyValue."""

    __msgtype__: ClassVar[str] = "diagnostic_msgs/msg/KeyValue"
    __typehash__: ClassVar[str] = "RIHS01_d68081eaa540288c5440753baecef0c4e16e81a5f78ad68902ded5100413bb42"

    key: str = ""
    value: str = ""


@dataclass(slots=True)
class DiagnosticStatus(Message):
    """diagnostic_msgs/msg/DiagnosticStatus."""

    __msgtype__: ClassVar[str] = "diagnostic_msgs/msg/DiagnosticStatus"
    __typehash__: ClassVar[str] = "RIHS01_b0e3e692ea2d54a8af2f4ef1930e81556a2db55216b771f8a7d2724ed47bf0e4"

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
    __typehash__: ClassVar[str] = "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"

    header: std_msgs.Header = dataclasses.field(default_factory=std_msgs.Header)
    status: list[DiagnosticStatus] = dataclasses.field(default_factory=list)
