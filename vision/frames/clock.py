"""Clocks from which frames get their stamps."""

from __future__ import annotations

import time
from typing import Protocol


class Clock(Protocol):
    """Clock of a program. Its time may jump back."""

    def now(self) -> int:
        """Return the time in nanoseconds since 1970, or since the start of a simulation."""

    def sleep_until(self, stamp: int) -> None:
        """Wait until a time in nanoseconds. If the clock jumps back, the wait may end before that time."""


class SystemClock:
    """Clock of the computer."""

    def now(self) -> int:
        """Return the time in nanoseconds since 1970."""
        return time.time_ns()

    def sleep_until(self, stamp: int) -> None:
        """Wait until a time in nanoseconds since 1970."""
        time.sleep(max(stamp - time.time_ns(), 0) / 1e9)


SYSTEM_CLOCK = SystemClock()
