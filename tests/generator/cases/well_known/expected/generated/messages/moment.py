# Generated from mapping.yaml (Moment); do not edit.
# Regenerate with: roverlink generate
"""The ROS message rover/msg/Moment."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Bool, Float64, Message
from roverlink.runtime.interfaces import Duration, Time


@dataclass(slots=True)
class Moment(Message):
    """Made from Moment."""

    __msgtype__: ClassVar[str] = "rover/msg/Moment"
    __typehash__: ClassVar[str] = (
        "RIHS01_052b52efb860b96f30c958e31ed256ef9cc4740ae051024b1957d002c9942945"
    )

    stamp: Time = dataclasses.field(default_factory=Time)
    """When it was measured."""

    has_seen: Bool = False
    """Whether seen is set."""

    seen: Time = dataclasses.field(default_factory=Time)
    took: Duration = dataclasses.field(default_factory=Duration)
    has_left: Bool = False
    """Whether left is set."""

    left: Duration = dataclasses.field(default_factory=Duration)
    has_calibrated: Bool = False
    has_level: Bool = False
    """Whether level is set."""

    level: Float64 = 0.0
