"""Judgement of a bridge's state for its page: which peers are alive, which stops are active, and latched alarms.

The state is a result of `roverlink.heard_bridges.page_of`. Times are in seconds of a monotonic clock.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

_SILENT_S = 3.0
"""Age in seconds of a peer's last message from which on the peer counts as silent, if its rows are not slower."""
_SILENT_PERIODS = 3
_BADNESS = ("OK", "WARN", "STALE", "ERROR")


def peers_of(node: Mapping[str, Any], rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the peers of the rows, each with its ``state``: alive, silent, or never (no message has come yet).

    A peer that only receives has the state "listens". ``age`` is the time since its last message; None if there was
    none. ``rate_in`` and ``rate_out`` are messages a second.
    """
    return [_peer(name, node, rows) for name in dict.fromkeys(row["peer"] for row in rows)]


def _peer(name: str, node: Mapping[str, Any], rows: list[dict[str, Any]]) -> dict[str, Any]:
    own = [row for row in rows if row["peer"] == name]
    inbound = [row for row in own if row["direction"].endswith("_to_ros")]
    age = min((row["age"] for row in inbound if "age" in row), default=None)
    # A peer that is expected to speak once in ten seconds is not silent between two messages.
    slowest = min((row["expect_rate"] for row in inbound if row.get("expect_rate")), default=None)
    limit = max(_SILENT_S, _SILENT_PERIODS / slowest if slowest else 0.0)
    if not inbound:
        state = "listens"
    elif age is None:
        state = "never"
    else:
        state = "alive" if age <= limit else "silent"
    rate_in = sum(row["rate"] for row in inbound)
    return {
        "name": name,
        "state": state,
        "age": age,
        "rate_in": rate_in,
        "rate_out": sum(row["rate"] for row in own) - rate_in,
        "stopping": [row["name"] for row in own if row.get("stopping")],
        "forwarded": node.get(f"forwarded.{name}", 0),
        "unsent": node.get(f"unsent.{name}", 0),
    }


class Condition(NamedTuple):
    """Reason for an alarm."""

    level: str
    """WARN, ERROR or STALE."""
    text: str


def conditions_of(state: Mapping[str, Any]) -> dict[str, Condition]:
    """Return what is wrong in a state with peers and stops, by subject."""
    found = {}
    if state["quiet"]:
        found["bridge"] = Condition("STALE", "the bridge no longer reports its state")
        return found  # the rest of the state is old
    if state["node"]["level"] != "OK":
        found["bridge"] = Condition(state["node"]["level"], state["node"]["message"])
    for peer in state["peers"]:
        if peer["state"] == "silent":
            found[f"peer {peer['name']}"] = Condition("ERROR", f"no message for {peer['age']:.0f} s")
    for row in state["rows"]:
        # A row that has never spoken is at rest: the bridge sends the stop from its start on.
        if row.get("stopping") and row["count"]:
            text = f"the topic is silent, so the bridge tells {row['peer']} to stop"
            found[f"stop {row['name']}"] = Condition("ERROR", text)
        if row["level"] != "OK":
            found[f"row {row['name']}"] = Condition(row["level"], row["message"])
    return found


@dataclass
class _Alarm:
    number: int
    """Number of this onset; it grows with every onset, so an acknowledged number stands for one onset."""
    subject: str
    level: str
    text: str
    since: float
    ended: float | None = None


class LinkAlarms:
    """Latched alarms: an alarm stays in the list when its condition has ended.

    There is one alarm for each subject at most, so the list is bounded. Browsers remember what was acknowledged.
    """

    def __init__(self) -> None:
        self._alarms: dict[str, _Alarm] = {}
        self._onsets = 0

    def update(self, conditions: Mapping[str, Condition], now: float) -> None:
        """Take what is wrong at the time ``now``: start new alarms, and end those whose condition is gone.

        A condition that comes back, or gets worse, starts its alarm anew with another number.
        """
        for subject, condition in conditions.items():
            alarm = self._alarms.get(subject)
            if alarm is None or alarm.ended is not None or _worse(condition.level, alarm.level):
                self._onsets += 1
                self._alarms[subject] = _Alarm(self._onsets, subject, condition.level, condition.text, now)
            else:
                alarm.text = condition.text
        for subject, alarm in self._alarms.items():
            if subject not in conditions and alarm.ended is None:
                alarm.ended = now

    def as_list(self) -> list[dict[str, Any]]:
        """Return all alarms since the start as plain values, the newest first."""
        return [asdict(alarm) for alarm in sorted(self._alarms.values(), key=lambda alarm: -alarm.number)]


def _worse(level: str, than: str) -> bool:
    return _rank(level) > _rank(than)


def _rank(level: str) -> int:
    return _BADNESS.index(level) if level in _BADNESS else len(_BADNESS)
