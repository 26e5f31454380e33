# Generated from mapping.yaml (Texts); do not edit.
# Regenerate with: roverlink generate
"""rover/msg/Texts."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from runtime.messages import Int32, Message


@dataclass(slots=True)
class Texts(Message):
    """Made from Texts."""

    __msgtype__: ClassVar[str] = "rover/msg/Texts"

    bytes_field: bytes = b""
    str_field: str = ""
    list_field: list[Int32] = dataclasses.field(default_factory=list)
    dataclasses_field: Int32 = 0
