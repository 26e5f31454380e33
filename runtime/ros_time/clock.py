"""Clocks of a program: that of the computer, and what every clock has."""

from __future__ import annotations

import time
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

    def now(self) -> int:
        """Return the time in nanoseconds since 1970."""
        return time.time_ns()

    def sleep_until(self, stamp: int, since: int) -> None:
        """Wait as long as it takes now until the time `stamp` in nanoseconds since 1970."""
        if self.now() < since:
            return
        time.sleep(max(stamp - time.time_ns(), 0) / 1e9)


SYSTEM_CLOCK = SystemClock()
