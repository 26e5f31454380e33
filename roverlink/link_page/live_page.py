"""Live state of all bridges of a page: keeps their links and their alarms, and sends events to browsers.

One thread does the work, twice a second. Each browser gets the list of the bridges and all alarms, and besides them the
events of the bridge that it shows.
"""

from __future__ import annotations

import logging
import secrets
import time
from collections.abc import Collection, Mapping, Sequence
from typing import Any

from roverlink.link_judgement import Condition, conditions_of, worst
from roverlink.link_page.event_clients import EventClients
from roverlink.link_page.last_values import LastValues
from roverlink.link_page.link_alarms import LinkAlarms
from roverlink.link_page.live_link import LiveLink, event
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.periodic_thread import PeriodicThread
from roverlink.runtime.ros_arguments.live_parameters import LiveParameters

_TICK_S = 0.5


class LivePage:
    """Live state of a page. A context manager; its thread sends events to `clients` inside the block."""

    def __init__(self, logger: logging.Logger, parameters: LiveParameters | None = None) -> None:
        """Log what is done on the page with ``logger``.

        ``parameters`` are those of the page's bridge; None if they belong to another process.
        """
        self.clients = EventClients()
        self.warnings: Sequence[str] = ()
        """Warnings about the bridges as a whole, such as two with one name."""
        self._logger, self._parameters = logger, parameters
        self._links: Mapping[str, LiveLink] = {}  # replaced and never changed, since several threads read it
        self._alarms = LinkAlarms()
        self._session = secrets.token_hex(8)
        self._start = time.monotonic()
        self._overview: dict[str, Any] = {}
        self._thread = PeriodicThread("page", _TICK_S, self.tick, logger)

    def add(self, id: str, values: LastValues | None = None) -> LiveLink:
        """Show one more bridge, and return its link; the arguments are those of `LiveLink`."""
        link = LiveLink(id, self._now, values)
        self._links = {**self._links, id: link}
        return link

    def remove(self, id: str) -> None:
        """Show a bridge no longer."""
        self._links = {other: link for other, link in self._links.items() if other != id}

    def known(self, bridge: str) -> str:
        """Return the id of the bridge that a browser asks for, or of the first one if it asks for none."""
        return bridge or min(self._links, default="")

    def snapshot(self, bridge: str, *, can_act: bool) -> bytes:
        """Return the events that a browser needs when it connects; ``can_act`` is true if the page has a token."""
        page = {"session": self._session, "can_act": can_act, "sets_parameters": self._parameters is not None}
        link = self._links.get(bridge)
        shown = link.snapshot() if link else b""
        return event("page", {**page, "bridge": bridge}) + event("bridges", self._bridges()) + shown

    def history(self, bridge: str, row: str, field: str) -> dict[str, Any]:
        """Return the points of a field of a bridge in the last minutes; `LiveLink.history` describes the field."""
        link = self._links.get(bridge)
        return {"now": self._now(), "points": link.history(row, field) if link else []}

    def acknowledge(self, numbers: Collection[int], address: str) -> None:
        """Acknowledge alarms for all browsers; ``address`` is that of the browser."""
        for subject in self._alarms.acknowledge(frozenset(numbers)):
            self._logger.info("the alarm %r was acknowledged on the page from %s", subject, address)

    def parameters_now(self) -> list[dict[str, Any]]:
        """Return the parameters that can change while the bridge runs; an empty list if they are of another process."""
        if self._parameters is None:
            return []
        values = self._parameters.values
        return [
            {
                "name": name,
                "value": values[name],
                "description": declared.description,
                "unit": declared.unit,
                "choices": declared.choices,
                "number": isinstance(declared.default, int),
            }
            for name, declared in self._parameters.declared.items()
            if not declared.read_only
        ]

    def change_parameters(self, changes: Mapping[str, Any]) -> None:
        """Change parameters of the bridge, all or none. Raises `SetupError` with the reason for none."""
        if self._parameters is None:
            raise SetupError("this page cannot set parameters; open the page of the bridge itself (run --page)")
        self._parameters.change(changes)

    def __enter__(self) -> LivePage:
        self._thread.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._thread.__exit__()
        self.clients.end()

    def _now(self) -> float:
        return round(time.monotonic() - self._start, 3)

    def tick(self) -> None:
        """Send what is new to all browsers; the thread of this object calls this periodically."""
        links = self._links
        self._alarms.keep(links.keys())
        news = {id: link.tick() for id, link in links.items()}
        for id, one in news.items():
            if (state := one.state) is not None:
                self._alarms.update(id, conditions_of(state), state["now"], state["quiet"])
        bridges = self._bridges()
        overview = {**bridges, "now": None}
        changed, self._overview = overview != self._overview, overview
        # A browser that comes from now on finds in its snapshot what is new here.
        events = {id: news[id].events() for id in self.clients.followed() if id in news}
        self.clients.send(event("bridges", bridges) if changed else b"", events)

    def _bridges(self) -> dict[str, Any]:
        entries = [link.entry() for _, link in sorted(self._links.items())]
        warnings = (Condition("WARN", text) for text in self.warnings)
        return {
            "now": self._now(),
            "bridges": entries,
            "worst": worst([*(Condition(**entry["worst"]) for entry in entries), *warnings])._asdict(),
            "warnings": list(self.warnings),
            "alarms": self._alarms.as_list(),
        }
