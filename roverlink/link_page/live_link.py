"""Live state of a bridge for its page: collects state, values and log, and sends them to browsers as events.

One thread does the work, twice a second. The bridge and its monitor only store references.
"""

from __future__ import annotations

import secrets
import threading
import time
from typing import Any

from roverlink.link_page.event_clients import EventClients
from roverlink.link_page.last_values import HISTORY_S, History, LastValues, Values
from roverlink.link_page.link_alarms import LinkAlarms, conditions_of, peers_of
from roverlink.link_page.log_lines import LogLines
from roverlink.topic_types import json_text

_TICK_S = 0.5
QUIET_S = 3.0
"""Time in seconds without a state after which the page says that the bridge no longer reports."""
LINK_FIELDS = ("rate", "age")
"""Fields of a row's own state that can be plotted besides those of its messages."""


class LiveLink:
    """Live state of one bridge. A context manager; its thread sends events to `clients` inside the block."""

    def __init__(self, values: LastValues | None = None) -> None:
        """Show the values of ``values``; None if only the bridge's state and log are known."""
        self.clients, self.log = EventClients(), LogLines()
        self._last_values = values
        self._history, self._link_history = History(), History()
        self._alarms = LinkAlarms()
        self._session = secrets.token_hex(8)
        self._start = time.monotonic()
        self._taken: tuple[float, dict[str, Any]] | None = None
        self._shown: dict[str, Any] | None = None
        self._state: dict[str, Any] = {}
        self._values: dict[str, Values] = {}
        self._told = 0
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name="page", daemon=True)

    def take_state(self, state: dict[str, Any]) -> None:
        """Take a new state of the bridge, a result of `roverlink.heard_bridges.page_of`; any thread may call this."""
        self._taken = (self._now(), state)

    def snapshot(self) -> bytes:
        """Return the events that a browser needs when it connects: state, values and log up to now."""
        values = {"now": self._now(), "rows": dict(self._values)}
        return b"".join(
            (
                *((_event("state", self._state),) if self._state else ()),
                _event("values", values),
                _event("log", {"lines": self.log.after(0)}),
            )
        )

    def history(self, row: str, field: str) -> dict[str, Any]:
        """Return the points of a field in the last minutes; a field of `LINK_FIELDS` has a ``#`` before its name."""
        link = field.startswith("#")
        points = (self._link_history if link else self._history).series(row, field.removeprefix("#"))
        return {"now": self._now(), "points": points}

    def __enter__(self) -> LiveLink:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ending.set()
        self._thread.join()
        self.clients.end()

    def _now(self) -> float:
        return round(time.monotonic() - self._start, 3)

    def _run(self) -> None:
        while not self._ending.wait(_TICK_S):
            self.tick()

    def tick(self) -> None:
        """Send what is new to all browsers; the thread of this object calls this periodically."""
        events = []
        if (state := self._new_state()) is not None:
            self._state = state
            events.append(_event("state", state))
        if self._last_values is not None:
            now, changes = self._now(), dict(self._last_values.changes())
            for row, values in changes.items():
                self._history.add(row, now, values)
            if changes:
                self._values = {**self._values, **changes}
                events.append(_event("values", {"now": now, "rows": changes}))
        if lines := self.log.after(self._told):
            self._told = lines[-1]["number"]
            events.append(_event("log", {"lines": lines}))
        if events:
            # In one piece, because each piece wakes a thread for each browser, and the bridge waits for these threads.
            self.clients.send(b"".join(events))

    def _new_state(self) -> dict[str, Any] | None:
        """Return the state to show; None if nothing has changed."""
        if self._taken is None:
            return None
        taken_at, given = self._taken
        now = self._now()
        quiet = now - taken_at > QUIET_S
        if given is self._shown and quiet == self._state["quiet"]:
            return None
        rows = given["rows"]
        if given is not self._shown:
            for row in rows:
                self._link_history.add(row["name"], now, {name: row[name] for name in LINK_FIELDS if name in row})
        self._shown = given
        state = {
            "session": self._session,
            "now": now,
            "taken": taken_at,
            "history": HISTORY_S,
            "has_values": self._last_values is not None,
            "quiet": quiet,
            "node": given["node"],
            "rows": rows,
            "peers": peers_of(given["node"], rows),
        }
        self._alarms.update(conditions_of(state), now)
        return {**state, "alarms": self._alarms.as_list()}


def _event(name: str, content: dict[str, Any]) -> bytes:
    return f"event: {name}\ndata: {json_text(content)}\n\n".encode()
