"""Functions that get a copy of what passes a bridge."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol


class Tap(Protocol):
    """Function that takes messages of one topic, or datagrams, oldest first. It must return at once."""

    def __call__(self, messages: Sequence[bytes], arrived: Sequence[int] = ()) -> None:
        """Take messages; ``arrived`` are their times in nanoseconds of the monotonic clock, empty for now."""
