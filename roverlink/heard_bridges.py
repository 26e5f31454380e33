"""Bridges whose state `roverlink top` hears on the topic ``/diagnostics``."""

from __future__ import annotations

import math
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from roverlink import link_judgement
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.interfaces.diagnostic_msgs import DiagnosticArray, DiagnosticStatus

_LEVELS = ("OK", "WARN", "ERROR", "STALE")
"""Names of the levels of a status, by their numbers in diagnostic_msgs/DiagnosticStatus."""
DROPPED = "dropped."
"""Prefix of the values that count drops by reason."""
QUIET_S = 3.0
"""Time in seconds without a message after which a bridge counts as quiet."""
_GONE_S = 60.0
"""Time in seconds without a message after which a bridge can make room for another one."""

_TEXTS = (
    *("full_name", "host", "instance", "fingerprint", "topic", "direction", "board", "recording"),
    *("address", "link", "fault", "state", "stamps"),
    *("schema", "differing", "untold"),
)
_NODE_VALUES = frozenset(("received", "received_rate", "kernel_drops", "socket_waiting_bytes", "socket_size_bytes"))
_LINK_VALUES = frozenset(("schema", "senders", "restarts"))
_ROW_VALUES = frozenset(("number", "topic", "direction", "count", "rate"))


@dataclass
class HeardBridge:
    """Bridge with its last state; times are in seconds of a monotonic clock."""

    state: dict[str, Any]
    """State, a result of `state_of`."""
    first: float
    """Time of the first message."""
    last: float
    """Time of the last message."""


class HeardBridges:
    """All bridges that were heard. A bridge is one process: two processes with the same node name are two bridges."""

    def __init__(
        self, nodes: Sequence[str] = (), clock: Callable[[], float] = time.monotonic, most: int | None = None
    ) -> None:
        """Hear only the bridges with the node names ``nodes``, with or without a namespace; for none, hear all.

        If ``most`` bridges are known, a further one takes the place of the one that has been gone longest, but at least
        for a minute.
        """
        self._nodes, self._clock, self._most = nodes, clock, most
        self._bridges: dict[tuple[str, str], HeardBridge] = {}
        self._full = -math.inf  # time when there was last no room for a bridge

    def take(self, message: bytes) -> dict[str, Any] | None:
        """Take a serialized message of ``/diagnostics``; return the state in it, or None if it is of another node."""
        try:
            state = state_of(cdr.decode(DiagnosticArray, message))
        except ConversionError:  # not written by a ROS 2 node
            return None
        if state is None or (self._nodes and not {state["node"]["name"], full_name(state)} & set(self._nodes)):
            return None
        now, key = self._clock(), (full_name(state), instance(state))
        # A bridge that was started again is a new process with the same name; the old one is of no more interest.
        gone = [
            other
            for other, heard in self._bridges.items()
            if other[0] == key[0] and other != key and heard.last < now - QUIET_S
        ]
        for other in gone:
            del self._bridges[other]
        if key not in self._bridges and not self._make_room(now):
            return None
        bridge = self._bridges.setdefault(key, HeardBridge(state, now, now))
        bridge.state, bridge.last = state, now
        return state

    def _make_room(self, now: float) -> bool:
        if self._most is None or len(self._bridges) < self._most:
            return True
        longest = min(self._bridges, key=lambda key: self._bridges[key].last)
        if self._bridges[longest].last > now - _GONE_S:
            self._full = now
            return False
        del self._bridges[longest]
        return True

    @property
    def bridges(self) -> list[HeardBridge]:
        """All bridges, sorted by name."""
        return [self._bridges[key] for key in sorted(self._bridges)]

    def state_now(self, bridge: HeardBridge) -> dict[str, Any]:
        """Return the state of a bridge, as `link_judgement.old` gives it if the bridge has been quiet for a while."""
        return link_judgement.old(bridge.state) if self._clock() - bridge.last > QUIET_S else bridge.state

    def warnings(self) -> list[str]:
        """Return a text for each name that several running bridges have, and one if there are too many bridges."""
        named: defaultdict[str, list[HeardBridge]] = defaultdict(list)
        for bridge in self.bridges:
            named[full_name(bridge.state)].append(bridge)
        texts = []
        for name, bridges in named.items():
            running = running_together(bridges)
            if running:
                places = ", ".join(place(bridge.state) for bridge in running)
                texts.append(
                    f"{len(running)} bridges are named {name!r}; start one with --ros-args -r __node:=NAME ({places})"
                )
        if self._full > self._clock() - QUIET_S:
            texts.append(f"more than {self._most} bridges are running; select some of them with --node")
        return texts


def running_together(bridges: Sequence[HeardBridge]) -> list[HeardBridge]:
    """Return those of several bridges with one name that run at the same time.

    A bridge that was started again is heard only after the old one; bridges that run together alternate.
    """
    newest = max(bridge.first for bridge in bridges)
    running = [bridge for bridge in bridges if bridge.last > newest]
    return running if len(running) > 1 else []


def full_name(state: dict[str, Any]) -> str:
    """Return the name of a bridge's node with its namespace."""
    return str(state["node"].get("full_name", state["node"]["name"]))


def place(state: dict[str, Any]) -> str:
    """Return where a bridge runs: ``process 4711 on jetson``."""
    return f"process {state['node'].get('pid', '?')} on {state['node'].get('host', '?')}"


def instance(state: dict[str, Any]) -> str:
    """Return the id of the process that a bridge is; empty if the bridge does not publish it."""
    return str(state["node"].get("instance", ""))


def state_of(array: DiagnosticArray) -> dict[str, Any] | None:
    """Convert a message of ``/diagnostics`` to the state of the bridge that published it; None for another node.

    The state is a dictionary for JSON: ``stamp`` (seconds since 1970), ``node`` (the bridge as a whole), ``rows`` (a
    list, with the verdicts of `judge_rows`), ``ends`` (a list: peers and boards with their addresses), ``links`` (a
    list of what the link messages of each end tell) and ``peers``, a result of `peers_of`. ``quiet`` is false
    here; see `link_judgement.old`. Texts that spell numbers become numbers.
    """
    own = next((status for status in array.status if any(pair.key == "fingerprint" for pair in status.values)), None)
    if own is None:
        return None
    node = _entry(own, own.name, _NODE_VALUES)
    prefix, of_links = f"{own.name}: ", f"{own.name} link: "
    parts = [status for status in array.status if status.name.startswith(prefix)]
    of_ends = [status for status in parts if any(pair.key == "link" for pair in status.values)]
    ends = _entries(of_ends, prefix, frozenset())
    rows = _entries([status for status in parts if status not in of_ends], prefix, _ROW_VALUES)
    links = _entries([status for status in array.status if status.name.startswith(of_links)], of_links, _LINK_VALUES)
    if node is None or rows is None or ends is None or links is None:
        return None
    peers = link_judgement.peers_of(node, rows, ends, links)
    link_judgement.judge_rows(rows, peers)
    return {
        "stamp": array.header.stamp.sec + array.header.stamp.nanosec / 1e9,
        "node": node,
        "rows": rows,
        "ends": ends,
        "links": links,
        "peers": peers,
        "quiet": False,
    }


def _entries(statuses: Iterable[DiagnosticStatus], prefix: str, needed: frozenset[str]) -> list[dict[str, Any]] | None:
    """Return the values of statuses, named without a prefix; None if one of them lacks a value of ``needed``."""
    entries = [_entry(status, status.name.removeprefix(prefix), needed) for status in statuses]
    found = [entry for entry in entries if entry is not None]
    return found if len(found) == len(entries) else None


def _entry(status: DiagnosticStatus, name: str, needed: frozenset[str]) -> dict[str, Any] | None:
    """Return the values of a status; None if one of the ``needed`` values is missing, so that no bridge wrote it."""
    level = _LEVELS[status.level] if status.level < len(_LEVELS) else str(status.level)
    values: dict[str, Any] = {}
    for pair in status.values:
        value = pair.value if pair.key in _TEXTS else _number(pair.value)
        if value is not None:
            values[pair.key] = value
    if not needed <= values.keys():
        return None
    return {"name": name, "level": level, "message": status.message, "peer": status.hardware_id, **values}


def _number(text: str) -> float | None:
    for kind in (int, float):
        try:
            number = kind(text)
        except ValueError:
            continue
        return number if math.isfinite(number) else None
    return None
