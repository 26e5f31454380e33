"""Latched alarms of the page of the link. Times are in seconds of a monotonic clock."""

from __future__ import annotations

import threading
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from roverlink.link_judgement import Condition, badness

_MOST = 500  # alarms


@dataclass
class _Alarm:
    number: int
    """Number of this onset; it grows with every onset, so an acknowledged number stands for one onset."""
    bridge: str
    """Id of the bridge."""
    subject: str
    level: str
    peak: str
    """Worst level since the onset."""
    text: str
    advice: str
    since: float
    ended: float | None = None
    acknowledged: bool = False
    """True if somebody with the token has acknowledged the alarm for all browsers."""


class LinkAlarms:
    """Latched alarms of all bridges: an alarm stays in the list when its condition has ended.

    There is one alarm for each bridge and subject at most; beyond 500, the oldest leave the list. Thread-safe.
    """

    def __init__(self) -> None:
        self._alarms: dict[tuple[str, str], _Alarm] = {}
        self._onsets = 0
        self._lock = threading.Lock()

    def update(self, bridge: str, conditions: Mapping[str, Condition], now: float, quiet: bool = False) -> None:
        """Take what is wrong with a bridge at the time ``now``: start new alarms, end those whose condition is gone.

        A condition that comes back, or gets worse, starts its alarm anew with another number. If the bridge is
        ``quiet``, nobody knows whether the other alarms are over: they go on, with the level UNKNOWN.
        """
        with self._lock:
            for subject, condition in conditions.items():
                alarm = self._alarms.pop((bridge, subject), None)
                if alarm is None or alarm.ended is not None or badness(condition.level) > badness(alarm.peak):
                    self._onsets += 1
                    alarm = _Alarm(self._onsets, bridge, subject, condition.level, condition.level, "", "", now)
                alarm.level, alarm.text, alarm.advice = condition
                self._alarms[bridge, subject] = alarm  # at the end: alarms that go on are the last to leave the list
            for (owner, subject), alarm in self._alarms.items():
                if owner == bridge and subject not in conditions and alarm.ended is None:
                    alarm.ended, alarm.level = (None, "UNKNOWN") if quiet else (now, alarm.level)
            while len(self._alarms) > _MOST:
                del self._alarms[next(iter(self._alarms))]

    def keep(self, bridges: Collection[str]) -> None:
        """Remove the alarms of all bridges but ``bridges``, because the page no longer shows the others."""
        with self._lock:
            self._alarms = {key: alarm for key, alarm in self._alarms.items() if alarm.bridge in bridges}

    def acknowledge(self, numbers: Collection[int]) -> list[str]:
        """Acknowledge alarms for all browsers, and return the subjects of those that were not acknowledged before."""
        with self._lock:
            new = [alarm for alarm in self._alarms.values() if alarm.number in numbers and not alarm.acknowledged]
            for alarm in new:
                alarm.acknowledged = True
            return [alarm.subject for alarm in new]

    def as_list(self) -> list[dict[str, Any]]:
        """Return all alarms as plain values: first those that go on, the worst first; then the others, newest first."""

        def order(alarm: _Alarm) -> tuple[bool, int, bool]:
            rank = badness(alarm.level) if alarm.ended is None else alarm.number
            return alarm.ended is not None, -rank, alarm.subject != "bridge"

        with self._lock:
            return [asdict(alarm) for alarm in sorted(self._alarms.values(), key=order)]
