# Generated from mapping.yaml (Another); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Int32, Message


@dataclass(slots=True)
class Another(Message):
    """Made from Another.

    This message is one more.
    """

    __msgtype__: ClassVar[str] = "rover/msg/Another"
    __typehash__: ClassVar[str] = (
        "RIHS01_fecbb7f5ab4d8d60949d517b7fea4f28d2d02d42b22035657c2c1c25112fedd2"
    )

    x: Int32 = 0
