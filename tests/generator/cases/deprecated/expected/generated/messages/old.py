# Generated from mapping.yaml (Old); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Old."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from generated.messages.bare import Bare
from roverlink.runtime.core.messages import Float32, Message, UInt8


@dataclass(slots=True)
class Old(Message):
    """Says too little.

    Deprecated.
    """

    __msgtype__: ClassVar[str] = "rover/msg/Old"
    __typehash__: ClassVar[str] = (
        "RIHS01_bdc1964ab20333fb1411d7ab8b24dff7d18d115bfc928295dcbbdaf1a8123a78"
    )

    OFF: ClassVar[int] = 0
    LOUD: ClassVar[int] = 1
    SHRILL: ClassVar[int] = 2

    angle: Float32 = 0.0
    """In degrees.

Deprecated.
"""

    bare: Float32 = 0.0
    """Deprecated."""

    mode: UInt8 = 0
    inner: Bare = dataclasses.field(default_factory=Bare)
