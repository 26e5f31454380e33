"""Rate limit for the messages of a row (table key ``max_rate``).

Times are arguments, in seconds of a monotonic clock.
"""

from __future__ import annotations

import threading
from collections.abc import Sequence


class Pacer:
    """Rate limit for the messages of one row. Safe to call from several threads.

    A message that comes too early waits until its time; a newer message replaces a waiting one.
    """

    def __init__(self, rate: float) -> None:
        """Let at most ``rate`` messages a second pass."""
        self._interval = 1 / rate
        self._slot = 0.0
        self._waiting: bytes | None = None
        self._lock = threading.Lock()

    @property
    def next_slot(self) -> float | None:
        """Time at which the waiting message may pass; None if no message waits."""
        return self._slot if self._waiting is not None else None

    def offer(self, messages: Sequence[bytes], now: float) -> tuple[Sequence[bytes], int]:
        """Return the newest message in a sequence if it may pass now; otherwise it waits for `take`.

        Return also how many messages it has superseded: those before it, and one that waited.
        """
        with self._lock:
            superseded = len(messages) - 1 + (self._waiting is not None)
            if now < self._slot:
                self._waiting = messages[-1]
                return (), superseded
            # From now and not from the last slot: after a pause, a burst must not catch up.
            self._waiting, self._slot = None, now + self._interval
            return messages[-1:], superseded

    def take(self, now: float) -> bytes | None:
        """Return the waiting message if it may pass now; None if it must still wait, or if no message waits."""
        with self._lock:
            if now < self._slot or self._waiting is None:
                return None
            message, self._waiting = self._waiting, None
            self._slot = now + self._interval
            return message

    def withdraw(self) -> bytes | None:
        """Remove and return the waiting message; None if no message waits."""
        with self._lock:
            message, self._waiting = self._waiting, None
            return message
