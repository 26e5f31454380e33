"""Judgement whether a peer or a board is alive, from the rows that it sends, and a log of its silences."""

from __future__ import annotations

import logging
from collections.abc import Collection, Iterable, Mapping
from typing import NamedTuple

from roverlink.runtime.core.registry import EndName

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


def liveness_of(rows: Iterable[tuple[float | None, float | None]], link_age: float | None = None) -> Liveness:
    """Return the liveness of a peer or a board.

    ``rows`` holds, for each row that comes from there, the seconds since its last message and its expected messages a
    second; either can be None. ``link_age`` is the seconds since its last link message; None if there was none. A link
    message alone means alive, unless a row has an expected rate.
    """
    rows = list(rows)
    if link_age is not None and not any(rate for _, rate in rows):
        rows.append((link_age, None))
    age = min((age for age, _ in rows if age is not None), default=None)
    # One that is expected to speak once in ten seconds is not silent between two messages.
    slowest = min((rate for _, rate in rows if rate), default=None)
    limit = max(_SILENT_S, _SILENT_PERIODS / slowest if slowest else 0.0)
    if not rows:
        return Liveness("listens", age, limit)
    if age is None:
        return Liveness("never", age, limit)
    return Liveness("alive" if age <= limit else "silent", age, limit)


def link_age(ages: Mapping[EndName, float], end: EndName) -> float | None:
    """Return the age of the last link message that speaks for a peer or a board; None if there was none.

    ``ages`` are those of each end that has sent one. A peer speaks for its boards, and each board for its peer.
    """
    of_peer = {one.board: age for one, age in ages.items() if one.peer == end.peer}
    return min((age for board, age in of_peer.items() if not board or end.board in ("", board)), default=None)


class SilenceLog:
    """Log of the peers and boards that fall silent, and of those that speak again."""

    def __init__(self, logger: logging.Logger) -> None:
        self._logger = logger
        self._silences: dict[EndName, float] = {}
        """Seconds since the last message of each end that is silent."""

    def take(self, ends: Mapping[EndName, Liveness]) -> None:
        """Log what has changed since the last call; a peer that changes together with one of its boards has no line."""
        silent = {name: one.age for name, one in ends.items() if one.state == "silent" and one.age is not None}
        fallen = silent.keys() - self._silences.keys()
        back = self._silences.keys() - silent.keys()
        for name in sorted(_without_their_peers(fallen)):
            self._logger.warning("%s fell silent: no message for %.1f s", name, silent[name])
        for name in sorted(_without_their_peers(back)):
            self._logger.info("%s speaks again after %.0f s of silence", name, self._silences[name])
        self._silences = silent


def _without_their_peers(names: Collection[EndName]) -> list[EndName]:
    peers = {name.peer for name in names if name.board}
    return [name for name in names if name.board or name.peer not in peers]
