# Generated from mapping.yaml (Texts); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Texts."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Int32, Message


@dataclass(slots=True)
class Texts(Message):
    """Made from Texts."""

    __msgtype__: ClassVar[str] = "rover/msg/Texts"
    __typehash__: ClassVar[str] = (
        "RIHS01_37eab907214867b990aaf02856ba78ea40a842386f6a9399bde5d2046c366de0"
    )

    bytes_field: bytes = b""
    str_field: str = ""
    list_field: list[Int32] = dataclasses.field(default_factory=list)
    dataclasses_field: Int32 = 0
