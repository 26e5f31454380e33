"""A limit of rate under which the newest wins: what comes too early waits, and only the newest waits.

Times are arguments, in seconds of a clock that never goes back.
"""

from __future__ import annotations

import threading
from typing import Generic, TypeVar

T = TypeVar("T")


class Pacer(Generic[T]):
    """Lets at most so many things a second pass on. May be called from several threads."""

    def __init__(self, rate: float) -> None:
        """``rate`` is the number of things a second."""
        self._interval = 1 / rate
        self._slot = 0.0
        self._waiting: T | None = None
        self._lock = threading.Lock()
        self.superseded = 0
        """Things that a newer one took the place of."""

    @property
    def next_slot(self) -> float | None:
        """When what waits may pass on; None where nothing waits."""
        return self._slot if self._waiting is not None else None

    def offer(self, thing: T, now: float) -> bool:
        """Whether a thing may pass on at once. If not, it waits for `take`, in the place of what has waited."""
        with self._lock:
            if self._waiting is not None:
                self.superseded += 1
            if now < self._slot:
                self._waiting = thing
                return False
            self._waiting, self._slot = None, now + self._interval
            return True

    def take(self, now: float) -> T | None:
        """What has waited long enough; None where nothing has."""
        with self._lock:
            if now < self._slot or self._waiting is None:
                return None
            thing, self._waiting = self._waiting, None
            self._slot = now + self._interval
            return thing

    def withdraw(self) -> T | None:
        """What waits, which then waits no more; None where nothing does."""
        with self._lock:
            thing, self._waiting = self._waiting, None
            return thing
