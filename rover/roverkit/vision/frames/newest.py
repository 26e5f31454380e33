"""Newest value of something, which one thread puts and any number of threads read. The writer never waits."""

from __future__ import annotations

import threading
from typing import Generic, TypeVar

T = TypeVar("T")


class Newest(Generic[T]):
    """Newest value. Values are numbered from 1; a slow reader misses values."""

    def __init__(self) -> None:
        self._news = threading.Condition()
        self._number = 0
        self._value: T
        self._closed = False

    @property
    def closed(self) -> bool:
        """True after `close`."""
        return self._closed

    def put(self, value: T) -> None:
        """Replace the value, and wake the readers that wait for a new one."""
        with self._news:
            self._number += 1
            self._value = value
            self._news.notify_all()

    def get(self, after: int, seconds: float | None = None) -> tuple[int, T] | None:
        """Wait for a value whose number exceeds `after`; return its number and the value.

        Returns None if no such value comes in this time (None: without a limit), or if the end comes first.
        """
        with self._news:
            self._news.wait_for(lambda: self._number > after or self._closed, seconds)
            return (self._number, self._value) if self._number > after else None

    def now(self) -> tuple[int, T]:
        """Return the number and the value at once. `put` must have been called before."""
        with self._news:
            return self._number, self._value

    def close(self) -> None:
        """End the waiting of all readers."""
        with self._news:
            self._closed = True
            self._news.notify_all()
