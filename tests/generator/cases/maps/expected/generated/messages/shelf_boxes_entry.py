# Generated from mapping.yaml (stock.Shelf.BoxesEntry); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/ShelfBoxesEntry."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.box import Box
from roverlink.runtime.core.messages import Message


@dataclass(slots=True)
class ShelfBoxesEntry(Message):
    """Made from stock.Shelf.BoxesEntry."""

    __msgtype__: ClassVar[str] = "rover/msg/ShelfBoxesEntry"
    __typehash__: ClassVar[str] = (
        "RIHS01_34cd699e7d6b3a794ab6a7158b804a61756e0f2c87924d50ab620ee25c45b0ae"
    )

    key: str = ""
    value: Box = dataclasses.field(default_factory=Box)
