# Generated from mapping.yaml (Ping); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Ping."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Message


@dataclass(slots=True)
class Ping(Message):
    """Made from Ping."""

    __msgtype__: ClassVar[str] = "rover/msg/Ping"
    __typehash__: ClassVar[str] = (
        "RIHS01_7611008c50a6e6f39ca91a721d63f84831c4199ce468fd615552e7cbe9c3e901"
    )
