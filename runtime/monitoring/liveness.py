"""Judgement whether a peer or a board is alive, from the rows that it sends."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

_SILENT_S = 3.0
"""Age in seconds of the last message from which on its sender counts as silent, if its rows are not slower."""
_SILENT_PERIODS = 3


class Liveness(NamedTuple):
    """Liveness of a peer or of a board."""

    state: str
    """``alive``, ``silent``, ``never`` (no message has come yet) or ``listens`` (no row comes from there)."""
    age: float | None
    """Seconds since the last message; None if there was none."""
    silent_after: float
    """Age in seconds from which on the peer or board counts as silent."""


def liveness_of(rows: Iterable[tuple[float | None, float | None]]) -> Liveness:
    """Return the liveness of a peer or a board.

    ``rows`` holds, for each row that comes from there, the seconds since its last message and its expected messages a
    second; either can be None.
    """
    rows = list(rows)
    age = min((age for age, _ in rows if age is not None), default=None)
    # One that is expected to speak once in ten seconds is not silent between two messages.
    slowest = min((rate for _, rate in rows if rate), default=None)
    limit = max(_SILENT_S, _SILENT_PERIODS / slowest if slowest else 0.0)
    if not rows:
        return Liveness("listens", age, limit)
    if age is None:
        return Liveness("never", age, limit)
    return Liveness("alive" if age <= limit else "silent", age, limit)
