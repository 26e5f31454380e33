"""Live state of one bridge on a page: collects state, values and log, and makes events of what is new."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from roverlink.heard_bridges import QUIET_S, full_name, place
from roverlink.link_judgement import Condition, old, worst_of
from roverlink.link_page.last_values import HISTORY_S, History, LastValues, SeenMessage, values_of
from roverlink.link_page.log_lines import LogLines
from roverlink.topic_types import json_text

LINK_FIELDS = ("rate", "age")
"""Fields of a row's own state that can be plotted besides those of its messages."""
_NOT_HEARD = Condition("WAITING", "the bridge has not reported yet")


class News(NamedTuple):
    """State, messages and log lines of a bridge that are new since the last tick."""

    now: float
    state: dict[str, Any] | None
    messages: Mapping[str, SeenMessage]
    lines: Sequence[dict[str, Any]]

    def events(self) -> bytes:
        """Return the events that tell it to a browser."""
        state = event("state", self.state) if self.state is not None else b""
        rows = values_of(self.messages)
        values = event("values", {"now": self.now, "rows": rows}) if rows else b""
        return state + values + (event("log", {"lines": self.lines}) if self.lines else b"")


class LiveLink:
    """Live state of one bridge. The bridge and its monitor only store references; `tick` does the work."""

    def __init__(self, id: str, clock: Callable[[], float], values: LastValues | None = None) -> None:
        """Show the values of ``values``; None if only the bridge's state and log are known.

        ``id`` names the bridge in the URL of the page. ``clock`` returns the page's time in seconds.
        """
        self.id, self.log = id, LogLines()
        self._clock, self._last_values = clock, values
        self._history, self._link_history = History(), History()
        self._taken: tuple[float, dict[str, Any]] | None = None
        self._shown: dict[str, Any] | None = None
        self.state: dict[str, Any] | None = None
        """State as the page shows it, with peers; None before the first."""
        self._messages: Mapping[str, SeenMessage] = {}  # replaced and never changed, since several threads read it
        self._told = 0

    def take_state(self, state: dict[str, Any]) -> None:
        """Take a new state of the bridge, a result of `roverlink.heard_bridges.state_of`; any thread may call this."""
        if self._taken is None or self._taken[1] is not state:
            self._taken = (self._clock(), state)

    def entry(self) -> dict[str, Any]:
        """Return the bridge's entry in the list of all bridges."""
        if self.state is None:
            return {"id": self.id, "name": self.id, "place": "", "worst": _NOT_HEARD._asdict()}
        worst = worst_of(self.state)
        return {"id": self.id, "name": full_name(self.state), "place": place(self.state), "worst": worst._asdict()}

    def snapshot(self) -> bytes:
        """Return the events that a browser needs when it connects: state, values and log up to now."""
        values = {"now": self._clock(), "rows": values_of(self._messages)}
        state = event("state", self.state) if self.state is not None else b""
        return state + event("values", values) + event("log", {"lines": self.log.after(0)})

    def history(self, row: str, field: str) -> list[tuple[float, float]]:
        """Return the points of a field in the last minutes; a field of `LINK_FIELDS` has a ``#`` before its name."""
        link = field.startswith("#")
        return (self._link_history if link else self._history).series(row, field.removeprefix("#"))

    def tick(self) -> News:
        """Return what is new since the last call; the thread of the page calls this periodically."""
        state, now = self._new_state(), self._clock()
        if state is not None:
            self.state = state
        messages = self._last_values.changes() if self._last_values is not None else {}
        for row, message in messages.items():
            self._history.add(row, now, message)
        self._messages = {**self._messages, **messages}
        if lines := self.log.after(self._told):
            self._told = lines[-1]["number"]
        return News(now, state, messages, lines)

    def _new_state(self) -> dict[str, Any] | None:
        """Return the state to show; None if nothing has changed."""
        if self._taken is None:
            return None
        taken_at, given = self._taken
        now = self._clock()
        quiet = now - taken_at > QUIET_S
        if given is self._shown and self.state is not None and quiet == self.state["quiet"]:
            return None
        shown = old(given) if quiet else given
        rows = given["rows"]
        if given is not self._shown:
            self._link_history.keep({row["name"] for row in rows})  # a bridge may come back with another table
            for row in rows:
                self._link_history.add(row["name"], now, {name: row[name] for name in LINK_FIELDS if name in row})
        self._shown = given
        return {
            "bridge": self.id,
            "now": now,
            "taken": taken_at,
            "history": HISTORY_S,
            "has_values": self._last_values is not None,
            **{name: shown[name] for name in ("quiet", "node", "rows", "peers")},
        }


def event(name: str, content: dict[str, Any]) -> bytes:
    """Return a server-sent event."""
    return f"event: {name}\ndata: {json_text(content)}\n\n".encode()
