"""When a peer has to be told to stop, because the topic that commands it has fallen silent.

Times are arguments, in seconds of a clock that never goes back. Silent is a topic of which no message passed on for a
while, for whatever reason: its publisher hangs, was killed or is gone; its messages cannot be converted; or the thread
that takes them stands still. What commanded the peer before the bridge started is not known, so a topic that has not
spoken since then is silent as well.
"""

from __future__ import annotations

import math
import threading


class Watchdog:
    """Watches one topic. May be called from several threads."""

    def __init__(self, after_s: float, repeat_s: float, now: float) -> None:
        """The topic may be silent for ``after_s``; then the stop is due, and again every ``repeat_s``."""
        self._after_s, self._repeat_s = after_s, repeat_s
        self._due = now + after_s
        self._silent = True
        self._lock = threading.Lock()

    @property
    def silent(self) -> bool:
        """Whether the topic has said nothing since the last stop, or since the start."""
        return self._silent

    @property
    def next_due(self) -> float:
        """When `is_due` is true next, if the topic says nothing until then."""
        return self._due

    def spoke(self, now: float) -> None:
        """A message of the topic passes on to the peer."""
        with self._lock:
            self._silent, self._due = False, now + self._after_s

    def lost_publisher(self) -> None:
        """Nobody publishes on the topic any more: the stop is due at once, unless the peer was told already."""
        with self._lock:
            if not self._silent:
                self._due = -math.inf

    def is_due(self, now: float) -> bool:
        """Whether the stop has to be sent now; whoever is told so sends it."""
        with self._lock:
            if now < self._due:
                return False
            self._silent, self._due = True, now + self._repeat_s
            return True
