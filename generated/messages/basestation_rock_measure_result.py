# Generated from mapping.yaml (BasestationRockMeasureResult); do not edit.
# Regenerate with: roverlink generate
"""comms/msg/BasestationRockMeasureResult."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from runtime.messages import Float32, Message


@dataclass(slots=True)
class BasestationRockMeasureResult(Message):
    """The measured size of a rock."""

    __msgtype__: ClassVar[str] = "comms/msg/BasestationRockMeasureResult"

    length_cm: Float32 = 0.0
    width_cm: Float32 = 0.0
