# Generated from mapping.yaml (Tidy); do not edit.
# Regenerate with: roverlink generate
"""rover/msg/Tidy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from runtime.messages import Int32, Message


@dataclass(slots=True)
class Tidy(Message):
    """A tidy sentence."""

    __msgtype__: ClassVar[str] = "rover/msg/Tidy"

    x: Int32 = 0
