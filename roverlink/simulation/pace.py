"""Pace of a simulated time beside the real time."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

_LAGGING_S = 1.0


class Pace:
    """Speed of the simulated time: a factor of the real time, or infinity for as fast as possible."""

    def __init__(self, factor: float, warn: Callable[[str], None]) -> None:
        """Begin now; ``warn`` is called once if this computer is too slow."""
        self._factor, self._warn = factor, warn
        self._start, self._skipped, self._warned = time.monotonic(), 0.0, False

    def wait(self, now: int) -> None:
        """Wait until the simulated time may be ``now``, in nanoseconds since the start."""
        if math.isinf(self._factor):
            return
        left = self._start + self._skipped + now / 1e9 / self._factor - time.monotonic()
        if left > 0:
            time.sleep(left)
        elif left < -_LAGGING_S:
            # A rover whose time makes up for a pause would send a flood.
            self._skipped -= left
            if not self._warned:
                self._warned = True
                self._warn(f"this computer is too slow for the real time (factor {self._factor:g})")
