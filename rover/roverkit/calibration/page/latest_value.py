"""Container for the latest value, which one thread writes and any number of threads read."""

from __future__ import annotations

import threading
from typing import Generic, TypeVar

T = TypeVar("T")


class LatestValue(Generic[T]):
    """Container for the latest value. Values are numbered. A slow reader misses values; the writer never waits."""

    def __init__(self) -> None:
        self._news = threading.Condition()
        self._number = 0
        self._held: T

    def put(self, thing: T) -> None:
        """Replace the value, and wake the readers that wait for a new one."""
        with self._news:
            self._number += 1
            self._held = thing
            self._news.notify_all()

    def get(self, after: int, patience_s: float) -> tuple[int, T] | None:
        """Wait until the number of the value exceeds `after`; return the number and the value.

        Returns None if no such value comes in `patience_s` seconds.
        """
        with self._news:
            there = self._news.wait_for(lambda: self._number > after, patience_s)
            return (self._number, self._held) if there else None

    def now(self) -> tuple[int, T]:
        """Return the number and the value at once. `put` must have been called before."""
        with self._news:
            return self._number, self._held
