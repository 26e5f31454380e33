# Generated from mapping.yaml (Remarks); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Remarks."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.another import Another
from generated.messages.args import Args
from generated.messages.quoted import Quoted
from generated.messages.tidy import Tidy
from roverlink.runtime.core.messages import Float32, Message, UInt8


@dataclass(slots=True)
class Remarks(Message):
    r"""Made from Remarks.

    this message's comment has no capital, no full stop
      an indented line,

    and a second paragraph with a \backslash, "quotes", '''three of them''' and 'one'.
    """

    __msgtype__: ClassVar[str] = "rover/msg/Remarks"
    __typehash__: ClassVar[str] = (
        "RIHS01_d937c0cc716823c7725209ce7cce5dc3133ac6fc0521c930f60201d63324d558"
    )

    LEVEL_SILENT: ClassVar[int] = 0
    LEVEL_LOUD: ClassVar[int] = 1

    before: Float32 = 0.0
    """Before the field. Ends with a quote: "so" """

    after: Float32 = 0.0
    """Behind the field, in °C | with a bar."""

    block: Float32 = 0.0
    """A block
of two lines.
"""

    both: Float32 = 0.0
    """Both: this one counts."""

    none: Float32 = 0.0
    slash: Float32 = 0.0
    r"""Ends with a backslash \\ """

    level: UInt8 = 0
    """no space
a tab
"""

    tidy: Tidy = dataclasses.field(default_factory=Tidy)
    quoted: Quoted = dataclasses.field(default_factory=Quoted)
    another: Another = dataclasses.field(default_factory=Another)
    args: Args = dataclasses.field(default_factory=Args)
