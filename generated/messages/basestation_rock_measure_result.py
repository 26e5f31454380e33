# Generated from mapping.yaml (BasestationRockMeasureResult); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/BasestationRockMeasureResult."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Float32, Message


@dataclass(slots=True)
class BasestationRockMeasureResult(Message):
    """The measured size of a rock."""

    __msgtype__: ClassVar[str] = "comms/msg/BasestationRockMeasureResult"
    __typehash__: ClassVar[str] = (
        "RIHS01_1d752e9c066556e1ffbd4a92faa7c1ba6a9d3d70cd0e8ed77cc7da3c4e97d924"
    )

    length_cm: Float32 = 0.0
    """Length [cm]."""
    width_cm: Float32 = 0.0
    """Width [cm]."""
