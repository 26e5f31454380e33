# Generated from mapping.yaml (Ping); do not edit.
# Regenerate with: roverlink generate
"""rover/msg/Ping."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from runtime.messages import Message


@dataclass(slots=True)
class Ping(Message):
    """Made from Ping."""

    __msgtype__: ClassVar[str] = "rover/msg/Ping"
