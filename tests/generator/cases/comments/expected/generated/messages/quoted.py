# Generated from mapping.yaml (Quoted); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Quoted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Int32, Message


@dataclass(slots=True)
class Quoted(Message):
    """Made from Quoted.

    "Quoted" from somewhere, as "it is"
    """

    __msgtype__: ClassVar[str] = "rover/msg/Quoted"
    __typehash__: ClassVar[str] = (
        "RIHS01_9ed6fbf8441f32aca6f3eb3931a87a53bb19c13085bbf11eed440f78b5417028"
    )

    x: Int32 = 0
