"""Distance that the wheels have rolled, from the odometer of the driving board: its signed metres since its start.

The distance between two reports is the difference of the odometer, whatever was lost, late or repeated between them. A
difference that no rover can drive in the time between the reports is an old report, or the board has started again:

- After a silence, the odometer is nearer to 0 than to where the last speed would have brought it. Then the board has
  started again. If both are about as near, the variance says so.
- For half a second, no report fits the old ones, but all fit each other. Then it has as well.
- Otherwise the report is ignored. Its distance is in the next one, too.

What the rover rolls while the board starts is in no report, and is computed from the speed. Times are in nanoseconds.
"""

from __future__ import annotations

import math
from collections import deque
from typing import NamedTuple

from roverkit.driving.arcs import Arc
from roverkit.odometry.rolled_distance import ACCELERATION, SPEED_LIMIT, STILL_S, TOLERANCE_M, Rolled
from roverkit.odometry.wheel_motors import FRESH_S

_SPEED_S = 0.3
"""Time over which the speed is the mean."""
_USUAL_DELAY_S = 0.03
"""Time after which the board has a command, if it does not say which one it drives."""


class _Report(NamedTuple):
    at: int
    odometer: float


class _Sent(NamedTuple):
    at: int
    number: int
    curvature: float


class OdometerDistance:
    """Reader of the driving board's odometer; see the module."""

    def __init__(self) -> None:
        self.ignored = 0
        """Number of reports that were ignored."""
        self._recent = deque[_Report]()  # the last one, and those before it from which the speed is computed
        self._unexplained = list[_Report]()  # the first and the last one that fit each other
        self._sent = deque[_Sent](maxlen=100)
        self._left = 0.0
        self._moved_at = 0
        self._curvature: float | None = 0.0

    @property
    def speed(self) -> float:
        """Mean speed of the wheels in m/s in the last reports, negative backwards."""
        if len(self._recent) < 2:
            return 0.0
        first, last = self._recent[0], self._recent[-1]
        return (last.odometer - first.odometer) / _seconds(first.at, last.at)

    def command(self, now: int, arc: Arc, number: int) -> None:
        """Take a command with its number, which is sent to the driving board now."""
        self._sent.append(_Sent(now, number, arc.curvature))

    def motors(self, now: int, rpm: float) -> None:
        """Take the mean speed of the wheels' motors, which the odometer makes needless."""

    def stands(self, now: int) -> bool:
        """Return true if the reports say that the rover stands."""
        if not self._recent or _seconds(self._recent[-1].at, now) > FRESH_S:
            return False
        return _seconds(self._moved_at, self._recent[-1].at) >= STILL_S

    def unreported(self, now: int) -> float:
        """Return the distance in metres that the rover may have driven since the last report, without its sign."""
        expected = abs(self.speed) * _seconds(self._recent[-1].at, now) if self._recent else 0.0
        return min(expected, abs(self._left)) if self._left else expected

    def report(self, now: int, left: float, odometer: float, number: int | None) -> Rolled | None:
        """Take a report: the distance left and the odometer in metres, and the number of the command if it is known.

        Return what the wheels have rolled since the last report; None if the report is ignored.
        """
        if not self._recent or now < self._recent[-1].at:  # the clock of a simulation may jump back
            self._begin(now, odometer)
            return Rolled(now, now, curvature=self._driven(now, number))
        last, report = self._recent[-1], _Report(now, odometer)
        distance, guessed = odometer - last.odometer, 0.0
        begins, unclear = self._begins(last, report)
        if begins or not _fit(last, report):
            if not (begins or self._agrees(report)):
                self.ignored += 1
                return None
            guessed = math.copysign(self.speed**2 / 2 / ACCELERATION, self.speed)
            # An odometer that begins anywhere else tells nothing about the time before.
            distance = guessed + (odometer if _fit_from_zero(last, report) else 0.0)
            self._begin(now, odometer)
        else:
            self._recent.append(report)
        self._unexplained.clear()
        if distance:
            self._moved_at = now
        while len(self._recent) > 2 and _seconds(self._recent[1].at, now) >= _SPEED_S:
            self._recent.popleft()
        self._left = left
        return Rolled(last.at, now, distance, guessed, guessed**2 + unclear**2, self._driven(now, number))

    def _begin(self, now: int, odometer: float) -> None:
        self._recent.clear()
        self._unexplained.clear()
        self._recent.append(_Report(now, odometer))
        self._moved_at = now

    def _begins(self, last: _Report, report: _Report) -> tuple[bool, float]:
        """Return whether a report after a silence is of a new start of the board, and the distance to the other case.

        This distance in metres is 0 where the two cases are clear.
        """
        seconds, distance = _seconds(last.at, report.at), report.odometer - last.odometer
        if seconds < STILL_S or abs(distance) <= TOLERANCE_M or not _fit_from_zero(last, report):
            return False, 0.0
        driven, begun = abs(distance - self.speed * seconds), abs(report.odometer)
        is_unclear = abs(begun - driven) < ACCELERATION * seconds**2 / 2
        return begun < driven, last.odometer if is_unclear else 0.0

    def _agrees(self, report: _Report) -> bool:
        """Return true if a report that does not fit the last one fits all others of half a second."""
        known = self._unexplained
        if known and _fit(known[-1], report):
            known[1:] = [report]
        else:
            known[:] = [report]
        return _seconds(known[0].at, report.at) >= STILL_S

    def _driven(self, now: int, number: int | None) -> float | None:
        """Return the curvature in 1/m of the command that the board drives; None if it is not known."""
        if number == 0:  # a stop without a number, after which the rover may roll on
            return self._curvature
        found = [
            one.curvature
            for one in self._sent
            if (one.number == number if number is not None else _seconds(one.at, now) >= _USUAL_DELAY_S)
        ]
        self._curvature = found[-1] if found else None if number is not None else 0.0
        return self._curvature


def _fit(before: _Report, after: _Report) -> bool:
    """Return true if a rover can drive from one report to the other one."""
    return abs(after.odometer - before.odometer) <= SPEED_LIMIT * _seconds(before.at, after.at) + TOLERANCE_M


def _fit_from_zero(before: _Report, after: _Report) -> bool:
    """Return true if a rover can drive the odometer of a report in the time since another one."""
    return _fit(_Report(before.at, 0.0), after)


def _seconds(since: int, until: int) -> float:
    return (until - since) / 1e9
