"""Clocks of a program: that of the computer, and what every clock has."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Protocol


class Clock(Protocol):
    """Clock of a program. Its time may jump back."""

    def now(self) -> int:
        """Return the time in nanoseconds since 1970, or since the start of a simulation."""

    def sleep_until(self, stamp: int, since: int) -> None:
        """Wait until the time `stamp` in nanoseconds.

        `since` is a time that the clock has shown before. If the clock shows less, then it has jumped back, and the
        wait ends before `stamp`.
        """


class SystemClock:
    """Clock of the computer."""

    def __init__(self, now: Callable[[], int]) -> None:
        """Show the time that ``now`` returns, in nanoseconds."""
        self.now = now

    def sleep_until(self, stamp: int, since: int) -> None:
        """Wait as long as it takes now until the time `stamp` in nanoseconds."""
        if self.now() < since:
            return
        time.sleep(max(stamp - self.now(), 0) / 1e9)


SYSTEM_CLOCK = SystemClock(time.time_ns)
"""Clock whose time is that since 1970. It jumps when somebody sets the time of the computer."""
MONOTONIC_CLOCK = SystemClock(time.monotonic_ns)
"""Clock for timeouts: it never jumps, and its time begins anywhere."""
