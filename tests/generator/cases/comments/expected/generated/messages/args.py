# Generated from mapping.yaml (Args); do not edit.
# Regenerate with: roverlink generate
"""rover/msg/Args."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from runtime.messages import Int32, Message


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

    x: Int32 = 0
