"""Distance that the wheels have rolled, from the commands and the reports of the driving board.

A report has one number, the distance left on the current command, and does not say which command this is. Commands can
be lost or late. Reports can be lost, repeated, late, or from a board that has restarted. So each report is compared
with the explanations below, and the one whose speed is nearest to the expected speed is taken.

- The board still drives the command of the last report. Then the distance between the two reports is exact.
- It drives a newer command. The distance on the new command is exact. The distance on the old one, between its last
  report and the change, is not reported, and is estimated.
- It has no command any more, and nothing is left: it has restarted, or the bridge has sent a stop.
- It drives a command that this program does not know, if two reports one after the other agree on this.

A report without an explanation is ignored, because it may be an old one. If it was not, then the distance that it
reports is in the next report, too.

The expected speed is that of the wheels' motors, whose revolutions per metre are learned from the exact distances. If
the motors report nothing, it is the speed between the last reports. All times are in nanoseconds.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, replace

from roverkit.driving.arcs import Arc
from roverkit.odometry.distance_rate import DistanceRate
from roverkit.odometry.wheel_motors import FRESH_S, Lesson, WheelMotors

SPEED_LIMIT = 3.0
"""Speed in m/s that no rover reaches; a report that implies more has another explanation."""
ACCELERATION = 1.0
"""Usual change of the speed in m/s^2."""
TOLERANCE_M = 0.005
"""Distance that is no distance."""
_JITTER_S = 0.005
"""Usual variation of the time that a message takes."""
_SLOW = 0.02
"""Speed in m/s below which the rover may start in either direction."""
_ENDED_COST = 3.0
"""Cost of the explanation that a command has ended for a reason that this program does not know."""
_LOST_COST, _MOST_SKIPPED = 2.0, 2
"""Cost of the explanation that a command was lost, and the number of them from which the link is broken."""
_USUAL_DELAY_S = 0.03
"""Time after which a command has usually arrived."""
_LIKELY_COST, _CLEAR_COST = 2.0, 1.0
"""Cost of an explanation below which it is likely, and the distance to all others from which it is clear."""
_MOST_UNCLEAR = 20
"""Number of unclear explanations, one after the other, from which the expected speed itself may be wrong."""
_ON_ITS_WAY_S = 2.0
"""Longest time that a command takes to the board."""
STILL_S = 0.5
"""Time without a change after which a rover stands whose motors report nothing."""
_ROLLS_OUT_S = 1.0
"""Longest time that the rover rolls after a stop."""
_MEASURABLE_S = 0.01
"""Shortest time for which a speed is computed."""
_GUESS = 0.03
"""Standard deviation of the relative error of distances that no report contains."""
_DELAY_S = 0.0025
"""Standard deviation of the time at which a command takes effect: half of the usual period of a board, 5 ms."""
_ALIKE = 10
"""Number of changes of the command whose errors are alike."""
_COMPARED, _NO_STEP_M = 50, 1e-6
"""Number of reports that are compared to find their step, and the distance in metres that rounding of numbers makes."""
_REPORT_DEVIATION_M = 0.001
"""Standard deviation of the distance in a report, because of its rounding and of its time."""


@dataclass(frozen=True, slots=True)
class Rolled:
    """Distance that the wheels have rolled between two reports."""

    since: int
    until: int
    distance: float = 0.0
    """Distance in metres, negative backwards."""
    unsure: float = 0.0
    """Standard deviation in metres of the error that is the same at each change of the command (`_at_changes`)."""
    variance: float = 0.0
    """Variance in m^2 of the part that no report contains, because of the times of messages and of accelerations."""
    curvature: float | None = 0.0
    """Curvature in 1/m of the command that the board drives; None if the command is not known."""

    def scaled(self, scale: float) -> Rolled:
        """Return the distance times a scale."""
        distance, unsure, variance = self.distance * scale, self.unsure * scale, self.variance * scale**2
        return replace(self, distance=distance, unsure=unsure, variance=variance)


@dataclass(frozen=True, slots=True)
class _Command:
    """Command of the driving board, and the time at which it was sent."""

    sent: int
    length: float
    curvature: float | None
    number: int = 0
    """Number by which reports name it; 0 if it has none."""


@dataclass(frozen=True, slots=True)
class _Explanation:
    """Explanation of a report: the command that the board drives, and the distance since the last report."""

    cost: float
    command: _Command
    distance: float
    guessed: float = 0.0
    """Part of the distance that no report contains, and that was computed from the speed."""
    variance: float = 0.0


class RolledDistance:
    """Reader of the driving board's reports; see the module."""

    def __init__(self) -> None:
        self._fastest = self._last_distance = 0.0
        self._unclear = 0
        self.ignored = 0
        """Number of reports that were ignored."""
        self._was_ignored = False
        self._lefts = deque[float](maxlen=_COMPARED)
        self._smallest = math.inf
        """Smallest difference in metres between two reports that came soon after each other."""
        self._motors = WheelMotors()
        self._by_time = DistanceRate(SPEED_LIMIT)
        self._sent = deque[_Command](maxlen=100)
        self._at: int | None = None
        self._begin(0, 0.0)

    def _begin(self, now: int, left: float) -> None:
        """Begin with a report, before which nothing is known."""
        known = (
            [command for command in self._sent if command.sent <= now and command.length / left >= 1] if left else []
        )
        self._command = known[-1] if known else _Command(now, left, None if left else 0.0)
        self._left, self._moved_at = left, now
        self._by_time.stop(SPEED_LIMIT if left else 0.0)
        self._sent.clear()
        self._strange: tuple[int, float] | None = None
        self._stopped_at, self._rolled_out = now, 0.0

    @property
    def speed(self) -> float:
        """Speed of the wheels in m/s at the last report, negative backwards."""
        if self._at is not None and self._motors.knows(self._at):
            return math.copysign(self._motors.speed, self._direction)
        return self._by_time.rate

    def command(self, now: int, arc: Arc, number: int = 0) -> None:
        """Take a command that is sent to the driving board now."""
        self._sent.append(_Command(now, arc.length, arc.curvature, number))

    def motors(self, now: int, rpm: float) -> None:
        """Take the mean speed of the wheels' motors, each without its sign, in revolutions per minute."""
        self._motors.add(now, rpm)

    def stands(self, now: int) -> bool:
        """Return true if the reports say that the rover stands."""
        if self._at is None or _seconds(self._at, now) > FRESH_S:
            return False
        if self._motors.are_fresh(now):
            return self._motors.stand and self._moved_at < self._at
        return self.speed == 0 and _seconds(self._moved_at, self._at) >= STILL_S

    def unreported(self, now: int) -> float:
        """Return the distance in metres that the rover may have driven since the last report, without its sign."""
        if self._at is None or self.speed == 0:
            return 0.0
        expected = abs(self.speed) * _seconds(self._at, now)
        return min(expected, abs(self._left)) if self._left else expected

    def report(self, now: int, left: float, number: int | None = None) -> Rolled | None:
        """Take a report: the distance left in metres, and the number of the command if the board reports it.

        Return what the wheels have rolled since the last report; None if the report is ignored.
        """
        if self._at is None or now < self._at:  # the clock of a simulation may jump back
            self._begin(now, left)
            self._at = now
            return Rolled(now, now, curvature=self._command.curvature)
        while self._sent and _seconds(self._sent[0].sent, now) > _ON_ITS_WAY_S:
            self._sent.popleft()
        found = [explanation for explanation in self._explanations(self._at, now, left) if explanation is not None]
        if number:
            found = [one for one in found if one.command.number == number] or found
        if found:
            best, *others = sorted(found, key=lambda explanation: explanation.cost)
            clear = best.cost < _LIKELY_COST and all(other.cost > best.cost + _CLEAR_COST for other in others)
            self._unclear += 1
            if clear or self._unclear > _MOST_UNCLEAR:
                self._unclear = 0
                self._learn(self._at, now, left, best)
            return self._accept(self._at, now, left, best)
        if left != self._left:
            adopted = self._adopted(self._at, now, left)
            if adopted is not None:
                return self._accept(self._at, now, left, adopted)
            self._was_ignored = True  # a repeated one is no loss
        self.ignored += 1
        return None

    # --- explanations ---

    def _explanations(self, since: int, now: int, left: float) -> list[_Explanation | None]:
        """Return the explanations of a report, that with the newest command first; None for an impossible one."""
        found = [self._replaced(since, now, left, command) for command in reversed(self._sent)]
        if abs(left) <= TOLERANCE_M < abs(self._left):
            found.append(self._stopped(_ENDED_COST, _Command(since, 0.0, 0.0), since, now))
        return [*found, self._continued(since, now, left)]

    def _continued(self, since: int, now: int, left: float) -> _Explanation | None:
        """Explain a report by the command of the last report."""
        distance = self._left - left
        if left == self._left:
            if left == 0:  # only the motors know how far the rover rolls after a stop
                return self._rolling_out(now)
            if abs(self.speed) > 0 and _seconds(since, now) < STILL_S:
                return None  # the last report has come twice
        cost = self._cost(since, now, distance, self._command)
        return (
            None
            if cost is None
            else _Explanation(cost + self._skipped(self._command.sent, now), self._command, distance)
        )

    def _replaced(self, since: int, now: int, left: float, command: _Command) -> _Explanation | None:
        """Explain a report by a command that was sent after that of the last report."""
        if command.length == 0:
            return None if left else self._stopped(0.0, command, since, now)
        distance = command.length - left
        cost = self._cost(max(command.sent, since), now, distance, command)
        if cost is None:
            return None
        return self._with_unseen(cost + self._skipped(command.sent, now), command, since, now, distance)

    def _with_unseen(self, cost: float, command: _Command, since: int, now: int, distance: float) -> _Explanation:
        """Return an explanation with a distance on a new command, and with the expected one on the old command."""
        expected, variance = self._expected(since, max(command.sent, since))
        expected += self.speed * (self._motors if self._motors.knows(now) else self._by_time).delay
        guessed = self._on_old_command(expected)
        return _Explanation(cost, command, distance + guessed, guessed, variance)

    def _stopped(self, cost: float, command: _Command, since: int, now: int) -> _Explanation:
        """Return an explanation with the expected distance before and after a stop; nothing reports it."""
        if self._motors.knows(now):
            expected, variance = self._expected(since, now)
        else:
            before, variance = self._expected(since, max(command.sent, since))
            after = min(abs(self.speed) * _seconds(max(command.sent, since), now), self.speed**2 / 2 / ACCELERATION)
            expected, variance = before + math.copysign(after, self.speed), variance + after**2 / 3
        guessed = self._on_old_command(expected)
        return _Explanation(cost, command, guessed, guessed, variance)

    def _on_old_command(self, expected: float) -> float:
        """Return an expected distance, limited to what was left of the old command."""
        if expected * self._direction < 0:
            return 0.0
        limit = abs(self._left) if self._left * expected > 0 else math.inf
        return math.copysign(min(abs(expected), limit), expected)

    def _rolling_out(self, now: int) -> _Explanation:
        """Explain a report that nothing is left, as before: only the motors know how far the rover rolls after a stop.

        The distance corrects those since the stop, which were computed before the motors reported for their time.
        """
        if not self._motors.knows(now) or _seconds(self._stopped_at, now) > _ROLLS_OUT_S:
            return _Explanation(0.0, self._command, 0.0)
        rolled = self._on_old_command(self._expected(self._stopped_at, now)[0])
        change = rolled - self._rolled_out
        return _Explanation(0.0, self._command, change, change)

    def _skipped(self, sent: int, now: int) -> float:
        """Return the cost of the explanation that commands which were sent after a time have not arrived yet."""
        skipped = sum(command.sent > sent and _seconds(command.sent, now) > _USUAL_DELAY_S for command in self._sent)
        return _LOST_COST * min(skipped, _MOST_SKIPPED)

    def _cost(self, since: int, now: int, distance: float, command: _Command) -> float | None:
        """Return how far a distance is from the expected one, in standard deviations; None if it is impossible."""
        seconds = _seconds(since, now)
        if abs(distance) > SPEED_LIMIT * seconds + TOLERANCE_M:
            return None
        # A rover that drives in the other direction brakes first, and then more is left than at the start.
        if distance * command.length < 0 and abs(distance) > TOLERANCE_M and self.speed * command.length >= 0:
            return None
        change = min(ACCELERATION * seconds / 2, SPEED_LIMIT) * seconds
        unsure = 0.0 if self._motors.knows(now) else math.sqrt(self._by_time.variance) * seconds
        deviation = TOLERANCE_M + _JITTER_S * abs(self.speed) + change + unsure
        # Over a longer time, the rover may have braked, but it was hardly faster than ever before.
        excess = max(abs(distance) - self._fastest * (seconds + _JITTER_S), 0.0) if self._fastest else 0.0
        return abs(distance - self._expected(since, now)[0]) / deviation + excess / TOLERANCE_M / 2

    def _expected(self, since: int, now: int) -> tuple[float, float]:
        """Return the expected distance between two times, and its variance."""
        seconds, jitter = _seconds(since, now), _JITTER_S * self.speed
        if self._motors.knows(now):
            rolled = self._motors.rolled(since, now)
            return math.copysign(rolled, self._direction), jitter**2
        change = min(ACCELERATION * seconds / 4, abs(self.speed)) * seconds
        return self.speed * seconds, jitter**2 + change**2

    @property
    def _direction(self) -> float:
        """Direction in which the wheels roll: its sign is that of the speed."""
        rate = self._by_time.rate
        return rate if abs(rate) > _SLOW else self._command.length or self._last_distance

    def _adopted(self, since: int, now: int, left: float) -> _Explanation | None:
        """Explain a report by a command that is not known, if it agrees with the unexplained one before it."""
        strange, self._strange = self._strange, (now, left)
        if strange is None:
            return None
        seconds, distance = _seconds(strange[0], now), strange[1] - left
        if not _MEASURABLE_S < seconds < STILL_S or not 0 <= distance * strange[1] <= abs(
            (SPEED_LIMIT * seconds + TOLERANCE_M) * strange[1]
        ):
            return None
        return self._with_unseen(0.0, _Command(strange[0], strange[1], None), since, now, distance)

    # --- the taken explanation ---

    def _accept(self, since: int, now: int, left: float, taken: _Explanation) -> Rolled:
        """Take an explanation as the true one."""
        command = taken.command
        if left == 0:
            if self._left != 0:
                guessed = command is not self._command and self._motors.knows(now)
                self._stopped_at, self._rolled_out = (since, 0.0) if guessed else (now, -taken.distance)
            self._rolled_out += taken.distance
            self._by_time.stop(_SLOW)
        else:
            self._by_time.drift(min(ACCELERATION * _seconds(since, now), SPEED_LIMIT))
        if taken.distance:
            self._moved_at = now
        if left:
            self._compare(left)
        same = self._at_changes(taken)
        if self._was_ignored:  # what the ignored report was about may have been driven, or not
            same, self._was_ignored = math.hypot(same, self.speed * _seconds(since, now)), False
        unsure, variance = math.copysign(same, taken.distance), taken.variance
        if command is not self._command:
            variance += _ALIKE * unsure**2
        if taken.distance and left:  # after a stop, a correction may be backwards
            self._last_distance = taken.distance
        while command in self._sent and self._sent.popleft() is not command:
            pass
        self._at, self._left, self._command, self._strange = now, left, command, None
        return Rolled(since, now, taken.distance, unsure, variance, command.curvature)

    def _compare(self, left: float) -> None:
        """Compare a report with others: those of a board that rounds differ by multiples of its step."""
        self._smallest = min(
            [self._smallest, *(apart for one in self._lefts if (apart := abs(left - one)) > _NO_STEP_M)]
        )
        self._lefts.append(left)

    def _at_changes(self, taken: _Explanation) -> float:
        """Return the standard deviation in metres of an error that cannot be known, because it hardly changes.

        If commands and reports have nearly the same rate, each change of the command comes at the same time before a
        report. Then the error of the delay, the rounding of the last report and of the first one after the change, and
        the error of the speed are the same each time, and add up. How long this lasts is not known either: so it counts
        once as an error that never changes, and once as one that is alike for some changes.
        """
        if taken.command is self._command:
            return _GUESS * taken.guessed
        # Two roundings, each with an error of the step divided by the root of 12.
        step = self._smallest if len(self._lefts) == _COMPARED else 0.0
        return math.hypot(_GUESS * taken.guessed, _DELAY_S * self.speed, step / math.sqrt(6))

    def _learn(self, since: int, now: int, left: float, taken: _Explanation) -> None:
        """Learn the speed from what is exact in an explanation."""
        if left == 0:
            return
        replaced = taken.command is not self._command
        begin, distance = (
            (max(taken.command.sent, since), taken.command.length - left) if replaced else (since, taken.distance)
        )
        if _seconds(begin, now) >= _MEASURABLE_S:
            deviation = math.hypot(_REPORT_DEVIATION_M, _JITTER_S / 2 * self.speed)
            self._motors.learn(Lesson(begin, now, abs(distance), deviation, replaced))
            span = _seconds(begin, now)
            self._by_time.measure(distance, deviation, span, 1.0 if replaced else 0.0)
            self._fastest = max(self._fastest, abs(self._by_time.rate))


def _seconds(since: int, until: int) -> float:
    return (until - since) / 1e9
