"""What a change breaks."""

from __future__ import annotations

from enum import IntEnum


class Breaks(IntEnum):
    """The gravest thing that a change breaks; what breaks bytes breaks all the rest too."""

    NOTHING = 0
    CODE = 1
    """Code that was written against what is generated, and nothing that travels."""
    JSON = 2
    """What is written as JSON, and not what is written as bytes."""
    WIRE = 3
    """Bytes: one side reads something else than the other wrote."""
