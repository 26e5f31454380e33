"""Datagrams that wait for the line to an end. It has no thread, no socket and no clock: times are arguments."""

from __future__ import annotations

import math
from collections import Counter, deque
from enum import Enum

_STALE_S = 0.5
"""Age in seconds at which a datagram is not sent any more: a command of the past must not move a rover."""
_MOST = 1024


class Undelivered(str, Enum):
    """Reason why a datagram that the program has sent to an end did not leave this computer."""

    STALE = "stale"
    """It waited for the line too long."""
    OVERFLOW = "overflow"
    """Too many datagrams waited for the line."""
    NOT_CONNECTED = "not_connected"
    """There is no connection to the end."""
    TOO_LARGE = "too_large"
    """The transport cannot carry so many bytes."""


class Outbox:
    """Queue of the datagrams to one end. To be used from one thread; another one may read the counts."""

    def __init__(self) -> None:
        self.undelivered: Counter[str] = Counter()
        """Datagrams that were discarded, by reason (`Undelivered`)."""
        self._waiting: deque[tuple[float, bytes]] = deque()

    def put(self, datagram: bytes, now: float) -> None:
        """Add a datagram that the program sends at the time ``now``."""
        if len(self._waiting) == _MOST:
            self._waiting.popleft()
            self.undelivered[Undelivered.OVERFLOW.value] += 1
        self._waiting.append((now, datagram))

    def take(self, now: float) -> bytes | None:
        """Remove and return the datagram to send now; None if there is none, or if it is not yet due."""
        while self._waiting:
            since, datagram = self._waiting.popleft()
            if now - since < _STALE_S:
                return datagram
            self.undelivered[Undelivered.STALE.value] += 1
        return None

    @property
    def next_due(self) -> float:
        """Time at which `take` should be called again; infinity if nothing waits."""
        return self._waiting[0][0] if self._waiting else math.inf
