# Generated from mapping.yaml (Args); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Args."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Int32, Message


@dataclass(slots=True)
class Args(Message):
    """Made from Args.

    Takes much.

    Args:
    x: the first

      indented more
    Returns:
    nothing, and this line is so long that it does not fit into the eighty-eight columns that generated code has.
    """

    __msgtype__: ClassVar[str] = "rover/msg/Args"
    __typehash__: ClassVar[str] = (
        "RIHS01_439ca630d740a232b390804f640662baf01f8c1c469a03ec47a8d2e18ac91d36"
    )

    x: Int32 = 0
