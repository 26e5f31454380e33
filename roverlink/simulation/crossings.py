"""Counters of bridged messages, one for each row of mapping.yaml, and the live table of `roverlink demo`."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from roverlink.runtime.core.registry import AnyHandler

if TYPE_CHECKING:
    from rich.table import Table

_WINDOW_S = 2.0
_SHOWN_FIELDS = 4


@dataclass
class Crossing:
    """Number of bridged messages of one row, with the last bridged message."""

    handler: AnyHandler
    count: int = 0
    last: Callable[[], dict[str, Any]] = dict
    """Function that decodes the last message to a dictionary of field values; called only when the message is shown."""
    _times: deque[float] = field(default_factory=deque)

    def add(self, last: Callable[[], dict[str, Any]]) -> None:
        """Count a bridged message. ``last`` is a function that returns the field values of this message."""
        self.count += 1
        self.last = last
        self._times.append(time.monotonic())

    def rate(self) -> float:
        """Return the number of messages a second, averaged over the last two seconds."""
        horizon = time.monotonic() - _WINDOW_S
        while self._times and self._times[0] < horizon:
            self._times.popleft()
        return len(self._times) / _WINDOW_S


def table(crossings: Iterable[Crossing], title: str) -> Table:
    """Return a table for the terminal: for each row its rate, its count, and the values of its last message."""
    from rich.table import Table  # here: the help of a command needs no rich

    shown = Table(title=title, expand=True)
    shown.add_column("no.", justify="right", no_wrap=True)
    shown.add_column("payload", no_wrap=True)
    shown.add_column("direction", no_wrap=True)
    shown.add_column("rate", justify="right", no_wrap=True)
    shown.add_column("count", justify="right", no_wrap=True)
    shown.add_column("last value", no_wrap=True, overflow="ellipsis", ratio=1)
    for crossing in crossings:
        route = crossing.handler.route
        shown.add_row(
            str(route.number),
            route.name,
            route.direction.replace("_to_", "→"),
            f"{crossing.rate():.1f}/s",
            str(crossing.count),
            brief(crossing.last()),
            style="" if crossing.count else "dim",
        )
    return shown


def brief(values: dict[str, Any]) -> str:
    """Return the first four fields of a message as text on one line: ``x 0.116, y -0.277, z 0.599``."""
    parts = [f"{name} {_short(value)}" for name, value in list(values.items())[:_SHOWN_FIELDS]]
    return ", ".join([*parts, "…"] if len(values) > _SHOWN_FIELDS else parts)


def _short(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(_short(part) for part in list(value.values())[:2]) + "…}"
    if isinstance(value, list):
        return f"[{len(value)}]"
    return f"{value:.3g}" if isinstance(value, float) else str(value)
