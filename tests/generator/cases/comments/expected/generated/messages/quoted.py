# Generated from mapping.yaml (Quoted); do not edit.
# Regenerate with: roverlink generate
"""rover/msg/Quoted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from runtime.messages import Int32, Message


@dataclass(slots=True)
class Quoted(Message):
    """Made from Quoted.

    "Quoted" from somewhere, as "it is"
    """

    __msgtype__: ClassVar[str] = "rover/msg/Quoted"

    x: Int32 = 0
