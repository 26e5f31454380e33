# Generated from mapping.yaml (Command); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Command."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.empty import Empty
from generated.messages.move import Move
from roverlink.runtime.core.messages import Bool, Float32, Int32, Message, UInt8, UInt16
from roverlink.runtime.interfaces import Time


@dataclass(slots=True)
class Command(Message):
    """Made from Command."""

    __msgtype__: ClassVar[str] = "rover/msg/Command"
    __typehash__: ClassVar[str] = (
        "RIHS01_d99a85431cd5b271b6f3f03da32875870140582f1c83985018614b870e75ca50"
    )

    ACTION_NONE: ClassVar[int] = 0
    ACTION_MOVE: ClassVar[int] = 2
    ACTION_STOP: ClassVar[int] = 3
    ACTION_GEAR: ClassVar[int] = 300
    ACTION_WAKE_AT: ClassVar[int] = 5
    ACTION_SCALE: ClassVar[int] = 6
    ACTION_SETTING: ClassVar[int] = 7
    ACTION_RAW: ClassVar[int] = 8
    ACTION_LIGHTS: ClassVar[int] = 9
    TARGET_NONE: ClassVar[int] = 0
    TARGET_NAME: ClassVar[int] = 10
    PARK: ClassVar[int] = 0
    DRIVE: ClassVar[int] = 1

    id: Int32 = 0
    which_action: UInt16 = 0
    """Which member of action is set."""

    move: Move = dataclasses.field(default_factory=Move)
    stop: Empty = dataclasses.field(default_factory=Empty)
    gear: UInt8 = 0
    wake_at: Time = dataclasses.field(default_factory=Time)
    scale: Float32 = 0.0
    setting: str = ""
    raw: bytes = b""
    lights: Bool = False
    which_target: UInt8 = 0
    """Which member of target is set."""

    name: str = ""
