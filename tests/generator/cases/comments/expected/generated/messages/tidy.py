# Generated from mapping.yaml (Tidy); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Tidy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Int32, Message


@dataclass(slots=True)
class Tidy(Message):
    """A tidy sentence."""

    __msgtype__: ClassVar[str] = "rover/msg/Tidy"
    __typehash__: ClassVar[str] = (
        "RIHS01_f3925ccf058fa657d7c9c817c5b6cd0c6c14a29e831dc14ac208be53134c3a82"
    )

    x: Int32 = 0
