# Generated from the definitions of ROS 2; do not edit.
# Regenerate with: make generate
"""Messages of the ROS 2 package std_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import Time


@dataclass(slots=True)
class Header(Message):
    """std_msgs/msg/Header."""

    __msgtype__: ClassVar[str] = "std_msgs/msg/Header"
    __typehash__: ClassVar[str] = "RIHS01_f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01"

    stamp: Time = dataclasses.field(default_factory=Time)
    frame_id: str = ""


@dataclass(slots=True)
class String(Message):
    """std_msgs/msg/String."""

    __msgtype__: ClassVar[str] = "std_msgs/msg/String"
    __typehash__: ClassVar[str] = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"

    data: str = ""
