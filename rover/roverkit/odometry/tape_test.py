"""Tape test: drives along a tape tell the scale of the distance, and the spread of the slip."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable

from roverkit.odometry.wheel_odometry import OdometryEstimate

_ENOUGH = 3
"""Number of drives from which their spread tells the slip."""


class TapeTest:
    """Drives along a tape of one length; each begins and ends where the rover stands."""

    def __init__(self, length: float, scale: Callable[[], float], say: Callable[[str], None]) -> None:
        """Begin; ``length`` is in metres, and ``scale`` returns the value of the parameter distance_scale."""
        self._length, self._scale, self._say = length, scale, say
        self._start: OdometryEstimate | None = None
        self._moves = False
        self._scales: list[float] = []

    def take(self, estimate: OdometryEstimate) -> None:
        """Take the newest estimate; say the result when the rover stands at the end of a drive."""
        if estimate.speed:
            self._moves = True
            return
        start, self._start = self._start, estimate
        if start is None or not self._moves:
            return
        self._moves = False
        distance = start.pose.distance_to(estimate.pose)
        if distance < self._length / 2:  # the rover was set to the start of the tape
            return
        self._scales.append(self._scale() * self._length / distance)
        mean, count = statistics.fmean(self._scales), len(self._scales)
        text = f"{distance:.3f} m by odometry on a tape of {self._length:g} m; after {count} drives, "
        text += f"distance_scale is {mean:.4f}"
        if count >= _ENOUGH:
            spread = statistics.stdev(self._scales) / mean
            text += f", mean_slip {spread / math.sqrt(count):.4f}, and slip {spread * math.sqrt(self._length):.3f}"
        self._say(text)
