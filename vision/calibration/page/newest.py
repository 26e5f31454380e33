"""Hands the newest of something from the one that makes it to all that want it."""

from __future__ import annotations

import threading
from typing import Generic, TypeVar

T = TypeVar("T")


class Newest(Generic[T]):
    """Holds one thing. Whoever is slow misses some; whoever makes them waits for nobody."""

    def __init__(self) -> None:
        self._news = threading.Condition()
        self._number = 0
        self._held: T

    def put(self, thing: T) -> None:
        """Replace it."""
        with self._news:
            self._number += 1
            self._held = thing
            self._news.notify_all()

    def get(self, after: int, patience_s: float) -> tuple[int, T] | None:
        """The thing and its number, once that is above `after`; None where it is not in time."""
        with self._news:
            there = self._news.wait_for(lambda: self._number > after, patience_s)
            return (self._number, self._held) if there else None

    def now(self) -> tuple[int, T]:
        """The thing and its number; there must be one."""
        with self._news:
            return self._number, self._held
