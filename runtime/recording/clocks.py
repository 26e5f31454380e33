"""Clocks of a recording: steady time for order and pace, and the time that the computer's clock showed.

The computer's clock may be set during a run: a board without a battery starts with a wrong time, and NTP corrects it
later. The monotonic clock is never set. The recorder therefore uses the monotonic clock, moved once so that both clocks
agree at the start of the recording. Slow corrections of NTP change the pace of both clocks alike (clock_gettime(2)), so
their distance changes only if the computer's clock is set.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from datetime import datetime, timedelta, timezone
from typing import NamedTuple

_JUMP_NS = 10_000_000  # smaller steps do not matter beside the delays of a network
_EXACT_NS = 1_000_000
_TRIES = 5


class ClockJump(NamedTuple):
    """Change of the computer's clock during a recording."""

    time: int
    """Steady time of the change, in nanoseconds since 1970."""
    before: int
    """Time that the clock would have shown without the change, in nanoseconds since 1970."""
    after: int
    """Time that the clock showed, in nanoseconds since 1970."""

    @property
    def by(self) -> int:
        """Size of the change in nanoseconds; negative if the clock was set back."""
        return self.after - self.before

    def facts(self) -> dict[str, str]:
        """Return the change as the facts of an MCAP metadata record."""
        return {name: str(value) for name, value in self._asdict().items()}

    @classmethod
    def from_facts(cls, facts: Mapping[str, str]) -> ClockJump:
        """Return the change from the facts of an MCAP metadata record. Raises `ValueError` if they are not times."""
        values = {name: int(facts.get(name, "")) for name in cls._fields}
        if not all(0 <= value < 1 << 64 for value in values.values()):
            raise ValueError("the time of a clock jump is not a time of MCAP")
        return cls(**values)

    def text(self, start: int) -> str:
        """Return the change and its distance to ``start``, the time of the first message, as text."""
        seconds = (self.time - start) / 1e9
        return f"{self}, {abs(seconds):.1f} s {'after' if seconds >= 0 else 'before'} the first message"

    def __str__(self) -> str:
        """Return the change as text: ``jumped by +1.500 s, from 2026-11-22 18:52:49 to 2026-11-22 18:52:50``."""
        size = abs(self.by) / 1e9
        spelled = f"{size:.3f} s" if size < 60 else str(timedelta(seconds=round(size)))
        sign = "-" if self.by < 0 else "+"
        return f"jumped by {sign}{spelled}, from {local_time(self.before)} to {local_time(self.after)}"


def local_time(nanoseconds: int) -> str:
    """Return a time in nanoseconds since 1970 as date and time of this computer's time zone."""
    since_1970 = datetime(1970, 1, 1, tzinfo=timezone.utc) + timedelta(microseconds=nanoseconds // 1000)
    return since_1970.astimezone().strftime("%Y-%m-%d %H:%M:%S")


class RunClock:
    """Clock of one run."""

    def __init__(self) -> None:
        """Start the clock: the steady time is now what the computer's clock shows."""
        self.clocks: tuple[Callable[[], int], Callable[[], int]] = (time.monotonic_ns, time.time_ns)
        """Monotonic clock, and computer's clock; each returns nanoseconds."""
        self.start = self._distance()[0]
        """Nanoseconds to add to the monotonic clock, for the steady time in nanoseconds since 1970."""
        self._last = self.start

    def jump(self) -> ClockJump | None:
        """Return how much the computer's clock was set since the last call; None if it was not."""
        distance, error = self._distance()
        by = distance - self._last
        if error > _EXACT_NS or abs(by) < _JUMP_NS:
            return None
        steady = time.monotonic_ns() + self.start
        after = steady - self.start + distance
        self._last = distance
        return ClockJump(steady, after - by, after)

    def _distance(self) -> tuple[int, int]:
        """Return by how much the computer's clock is ahead of the monotonic clock, and the error, in nanoseconds."""
        monotonic, wall = self.clocks
        tries = []
        for _ in range(_TRIES):
            before, shown, after = monotonic(), wall(), monotonic()
            tries.append((after - before, shown - (before + after) // 2))
            # Another thread or program may run between the calls; then the distance is not exact.
            if after - before < _EXACT_NS:
                break
        error, distance = min(tries)
        return distance, error
