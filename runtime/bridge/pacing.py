"""Rate limit for values, which are the messages of a row (table key ``max_rate``).

A value that comes too early waits until its time; a newer value replaces a waiting one.

Times are arguments, in seconds of a monotonic clock.
"""

from __future__ import annotations

import threading
from typing import Generic, TypeVar

T = TypeVar("T")


class Pacer(Generic[T]):
    """Rate limit for the values of one row, usually its messages. Safe to call from several threads.

    A value that comes too early waits until its time; a newer value replaces a waiting one.
    """

    def __init__(self, rate: float) -> None:
        """Let at most ``rate`` values a second pass."""
        self._interval = 1 / rate
        self._slot = 0.0
        self._waiting: T | None = None
        self._lock = threading.Lock()
        self.superseded = 0
        """Number of values that a newer one has replaced."""

    @property
    def next_slot(self) -> float | None:
        """Time at which the waiting value may pass; None if no value waits."""
        return self._slot if self._waiting is not None else None

    def offer(self, thing: T, now: float) -> bool:
        """Return true if a value may pass now. Otherwise the value waits for `take`, in place of an older value."""
        with self._lock:
            if self._waiting is not None:
                self.superseded += 1
            if now < self._slot:
                self._waiting = thing
                return False
            # From now and not from the last slot: after a pause, a burst must not catch up.
            self._waiting, self._slot = None, now + self._interval
            return True

    def take(self, now: float) -> T | None:
        """Return the waiting value if it may pass now; None if it must still wait, or if no value waits."""
        with self._lock:
            if now < self._slot or self._waiting is None:
                return None
            thing, self._waiting = self._waiting, None
            self._slot = now + self._interval
            return thing

    def withdraw(self) -> T | None:
        """Remove and return the waiting value; None if no value waits."""
        with self._lock:
            thing, self._waiting = self._waiting, None
            return thing
