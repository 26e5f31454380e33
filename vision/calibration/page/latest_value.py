"""Latest value of something, passed from one producer to any number of readers."""

from __future__ import annotations

import threading
from typing import Generic, TypeVar

T = TypeVar("T")


class LatestValue(Generic[T]):
    """Latest value. A slow reader misses values; the producer never waits."""

    def __init__(self) -> None:
        self._news = threading.Condition()
        self._number = 0
        self._held: T

    def put(self, thing: T) -> None:
        """Replace the value."""
        with self._news:
            self._number += 1
            self._held = thing
            self._news.notify_all()

    def get(self, after: int, patience_s: float) -> tuple[int, T] | None:
        """Return value and number when the number exceeds `after`; None if that does not happen in time."""
        with self._news:
            there = self._news.wait_for(lambda: self._number > after, patience_s)
            return (self._number, self._held) if there else None

    def now(self) -> tuple[int, T]:
        """Return value and number; a value must have been put before."""
        with self._news:
            return self._number, self._held
