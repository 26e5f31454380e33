# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Messages of the ROS 2 package std_msgs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from runtime.interfaces import Time
from runtime.messages import Message


@dataclass(slots=True)
class Header(Message):
    """std_msgs/msg/Header."""

    __msgtype__: ClassVar[str] = "std_msgs/msg/Header"

    stamp: Time = dataclasses.field(default_factory=Time)
    frame_id: str = ""
