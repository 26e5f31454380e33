# Generated from mapping.yaml (BasestationRockMeasureResult); do not edit.
# Regenerate with: roverlink generate
"""ROS message comms/msg/BasestationRockMeasureResult."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roverlink.runtime.core.messages import Float32, Message, UInt8


@dataclass(slots=True)
class BasestationRockMeasureResult(Message):
    """The measured size of a rock."""

    __msgtype__: ClassVar[str] = "comms/msg/BasestationRockMeasureResult"
    __typehash__: ClassVar[str] = (
        "RIHS01_2e9920042799bb2ccf6c83a6d16e76f5d378624c1a6bf2b3177218a4c39e7e5c"
    )

    # Values of failure
    ROCK_MEASURE_FAILURE_NONE: ClassVar[int] = 0
    ROCK_MEASURE_FAILURE_NO_IMAGE: ClassVar[int] = 1
    ROCK_MEASURE_FAILURE_OUTSIDE_IMAGE: ClassVar[int] = 2
    ROCK_MEASURE_FAILURE_SHORT_LINE: ClassVar[int] = 3
    ROCK_MEASURE_FAILURE_NOT_ALIGNED: ClassVar[int] = 4
    ROCK_MEASURE_FAILURE_LITTLE_DEPTH: ClassVar[int] = 5
    ROCK_MEASURE_FAILURE_NO_PLANE: ClassVar[int] = 6
    ROCK_MEASURE_FAILURE_NO_ROCK: ClassVar[int] = 7
    ROCK_MEASURE_FAILURE_CUT_OFF: ClassVar[int] = 8
    ROCK_MEASURE_FAILURE_LINE_MISMATCH: ClassVar[int] = 9

    length_cm: Float32 = 0.0
    """Length [cm]."""
    width_cm: Float32 = 0.0
    """Width [cm]."""
    failure: UInt8 = 0
    """If it is not NONE, all sizes are NaN."""
    length_sigma_cm: Float32 = 0.0
    """Standard deviation of the length [cm]."""
    width_sigma_cm: Float32 = 0.0
    """Standard deviation of the width [cm]."""
