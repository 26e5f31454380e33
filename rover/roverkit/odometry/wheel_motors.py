"""Distance that a rover's wheels roll, from the reports of their motors, whose revolutions per metre are learned."""

from __future__ import annotations

import itertools
from collections import deque
from typing import NamedTuple

from roverkit.odometry.distance_rate import DistanceRate

FRESH_S = 0.3
"""Age in seconds up to which the last speed of the motors is that of now."""
_STANDING_RPM = 0.5
"""Speed below which a motor stands."""
_REPORTS = 30
_LONGEST_REVOLUTION_M = 5.0
"""Standard deviation of the distance per revolution before anything is known about it."""
_KNOWN = 0.1
"""Standard deviation of the distance per revolution, as a part of it, from which it is used."""
_DRIFT = 1e-3
"""Change of the distance per revolution between two measurements, as a part of it."""


class Lesson(NamedTuple):
    """Distance in metres that the wheels have rolled between two times, without its sign."""

    since: int
    until: int
    distance: float
    deviation: float
    """Standard deviation of the distance."""
    delayed: bool
    """True if the distance is shorter by the delay."""


class WheelMotors:
    """Reports of the motors: speeds without their signs, in revolutions per minute. Times are in nanoseconds."""

    def __init__(self) -> None:
        self._reports = deque[tuple[int, float]](maxlen=_REPORTS)
        self._lessons = deque[Lesson](maxlen=_REPORTS)
        self._revolution = DistanceRate(_LONGEST_REVOLUTION_M)

    def add(self, now: int, rpm: float) -> None:
        """Take a report."""
        if self._reports and now < self._reports[-1][0]:  # the clock of a simulation has jumped back
            self._reports.clear()
            self._lessons.clear()
        self._reports.append((now, rpm / 60 if rpm >= _STANDING_RPM else 0.0))
        while self._lessons and self._lessons[0].until <= now:
            self._take(self._lessons.popleft())

    def are_fresh(self, now: int) -> bool:
        """Return true if the motors have reported lately."""
        return bool(self._reports) and abs(now - self._reports[-1][0]) <= FRESH_S * 1e9

    @property
    def stand(self) -> bool:
        """True if the last two reports say that the motors stand."""
        return len(self._reports) > 1 and not any(turns for _, turns in (self._reports[-1], self._reports[-2]))

    def knows(self, now: int) -> bool:
        """Return true if distances are known: the motors report, and the distance per revolution was learned."""
        known = self._revolution
        return self.are_fresh(now) and known.variance < (_KNOWN * known.rate) ** 2

    @property
    def speed(self) -> float:
        """Speed of the wheels in m/s at the last report, without its sign."""
        return self._revolution.rate * self._reports[-1][1]

    @property
    def delay(self) -> float:
        """Time in seconds that a command and a report are on their way together."""
        return self._revolution.delay

    def rolled(self, since: int, until: int) -> float:
        """Return the distance in metres that the wheels have rolled between two times."""
        return self._revolution.rate * self._turned(since, until)

    def learn(self, lesson: Lesson) -> None:
        """Learn from a distance, as soon as the motors have reported for its time.

        While the rover accelerates, the last speed is not yet that of now.
        """
        self._lessons.append(lesson)

    def _take(self, lesson: Lesson) -> None:
        if lesson.since < self._reports[0][0] or (turned := self._turned(lesson.since, lesson.until)) == 0:
            return
        flow = turned / (lesson.until - lesson.since) * 1e9 if lesson.delayed else 0.0
        self._revolution.drift(_DRIFT * self._revolution.rate)
        self._revolution.measure(lesson.distance, lesson.deviation, turned, flow)

    def _turned(self, since: int, until: int) -> float:
        """Return the revolutions between two times. The speed between two reports is interpolated."""
        turned = 0.0
        first, last = self._reports[0], self._reports[-1]
        points = [(min(since, first[0]), first[1]), *self._reports, (max(until, last[0]), last[1])]
        for (start, before), (end, after) in itertools.pairwise(points):
            begin, finish = max(start, since), min(end, until)
            if begin < finish:
                slope = (after - before) / (end - start)
                turned += (finish - begin) * (before + slope * ((begin + finish) / 2 - start))
        return turned / 1e9
