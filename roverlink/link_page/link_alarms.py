"""Judgement of a bridge's state for its page: which peers are alive, which stops are active, and latched alarms.

The state is a result of `roverlink.heard_bridges.state_of`. Times are in seconds of a monotonic clock.
"""

from __future__ import annotations

import threading
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

from roverlink.heard_bridges import badness
from roverlink.runtime.monitoring.liveness import liveness_of
from roverlink.runtime.monitoring.monitor import ADDRESS_PROBLEMS

_STATES = ("alive", "silent", "never", "listens")
"""States of peers and boards; that of a peer is the first that one of its boards has."""
_MOST = 500  # alarms


def peers_of(
    node: Mapping[str, Any],
    rows: Sequence[dict[str, Any]],
    ends: Sequence[Mapping[str, Any]] = (),
    links: Sequence[Mapping[str, Any]] = (),
) -> list[dict[str, Any]]:
    """Return the peers of the rows and ends.

    The ``state`` of each is alive, silent, never (no message has come yet) or listens (it only receives). ``age`` is
    the time since its last message; None if there was none. ``rate_in`` and ``rate_out`` are messages a second.
    ``boards`` are the boards of the peer, with the same keys; a peer with boards is alive if one of them is.

    ``ends`` are the ends of the link in the bridge's state. A peer or board with an address of its own has this
    ``address`` and ``link``, the state of the address. ``links`` are the results of the link messages; a peer or board
    with a result has it as ``report``.
    """
    # A peer to which rows are only forwarded has no row of its own.
    peers = [_peer(name, node, rows) for name in dict.fromkeys(entry["peer"] for entry in (*rows, *ends))]
    end_of = {(end["peer"], end.get("board", "")): end for end in ends}
    report_of = {(link["peer"], link.get("board", "")): link for link in links}
    for peer in peers:
        for board, shown in (("", peer), *((board["name"], board) for board in peer["boards"])):
            end = end_of.get((peer["name"], board))
            if end is not None and (not board or end.get("address") != peer.get("address")):
                shown |= {"address": end.get("address", ""), "link": end["link"]}
            if report := report_of.get((peer["name"], board)):
                shown["report"] = report
    return peers


def _peer(name: str, node: Mapping[str, Any], rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    own = [row for row in rows if row["peer"] == name]
    boards = dict.fromkeys(row.get("board", "") for row in own)
    # The rows without a board are a part as well.
    parts = [_end(board, [row for row in own if row.get("board", "") == board]) for board in boards]
    return {
        **_end(name, own),
        "state": min((part["state"] for part in parts), key=_STATES.index, default="listens"),
        "boards": [part for part in parts if part["name"]],
        "stopping": [row["name"] for row in own if row.get("stopping")],
        "forwarded": node.get(f"forwarded.{name}", 0),
        "unsent": node.get(f"unsent.{name}", 0),
    }


def _end(name: str, rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Return what peers and boards have in common; ``silent_after`` is the age at which the end counts as silent."""
    inbound = [row for row in rows if row["direction"].endswith("_to_ros")]
    liveness = liveness_of((row.get("age"), row.get("expect_rate")) for row in inbound)
    rate_in = sum(row["rate"] for row in inbound)
    return {
        "name": name,
        **liveness._asdict(),
        "rate_in": rate_in,
        "rate_out": sum(row["rate"] for row in rows) - rate_in,
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
        for shown in (peer, *peer["boards"]):
            owner = peer["name"] if shown is peer else f"{shown['name']} of {peer['name']}"
            # An address that is not learned is no alarm, as no message yet is none.
            if shown.get("link") != "not_learned" and (problem := ADDRESS_PROBLEMS.get(shown.get("link", ""))):
                found[f"link {owner}"] = Condition(problem[0].name, problem[1])
            if (report := shown.get("report")) and report["level"] != "OK":
                found[f"schema {owner}"] = Condition(report["level"], report["message"])
        for board in peer["boards"]:
            # Boards that fall silent together are one alarm, that of the peer. So a board has an alarm only if the peer
            # has spoken since the board was due. The alarm stays if the rest of the peer falls silent later.
            if board["state"] == "silent" and board["age"] - peer["age"] > board["silent_after"]:
                subject = f"board {board['name']} of {peer['name']}"
                found[subject] = Condition("ERROR", f"no message for {board['age']:.0f} s")
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
    bridge: str
    """Id of the bridge."""
    subject: str
    level: str
    text: str
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

    def update(self, bridge: str, conditions: Mapping[str, Condition], now: float) -> None:
        """Take what is wrong with a bridge at the time ``now``: start new alarms, end those whose condition is gone.

        A condition that comes back, or gets worse, starts its alarm anew with another number.
        """
        with self._lock:
            for subject, condition in conditions.items():
                alarm = self._alarms.pop((bridge, subject), None)
                if alarm is None or alarm.ended is not None or badness(condition.level) > badness(alarm.level):
                    self._onsets += 1
                    alarm = _Alarm(self._onsets, bridge, subject, condition.level, condition.text, now)
                alarm.text = condition.text
                self._alarms[bridge, subject] = alarm  # at the end: alarms that go on are the last to leave the list
            for (owner, subject), alarm in self._alarms.items():
                if owner == bridge and subject not in conditions and alarm.ended is None:
                    alarm.ended = now
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
        """Return all alarms since the start as plain values, the newest first."""
        with self._lock:
            return [asdict(alarm) for alarm in sorted(self._alarms.values(), key=lambda alarm: -alarm.number)]
