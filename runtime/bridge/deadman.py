"""Watchdog of a topic that commands a peer (table key ``deadman``): says when to send the stop.

A topic is silent if no message has passed on to the peer for a while, whatever the cause: the publisher hangs, was
killed or has left; its messages cannot be converted; or the thread that receives them is blocked. At start the topic
counts as silent, because nobody knows which command the peer got before.

Times are arguments, in seconds of a monotonic clock.
"""

from __future__ import annotations

import math
import threading


class Watchdog:
    """Watchdog of one topic. Safe to call from several threads."""

    def __init__(self, after_s: float, repeat_s: float, now: float) -> None:
        """Let the stop be due after ``after_s`` of silence, and again every ``repeat_s``."""
        self._after_s, self._repeat_s = after_s, repeat_s
        self._due = now + after_s
        self._silent = True
        self._lock = threading.Lock()

    @property
    def silent(self) -> bool:
        """True if no message has passed since the last stop, or since the start."""
        return self._silent

    @property
    def next_due(self) -> float:
        """Time at which `is_due` becomes true if no message passes before."""
        return self._due

    def message_passed(self, now: float) -> None:
        """Note that a message has passed on to the peer."""
        with self._lock:
            self._silent, self._due = False, now + self._after_s

    def lost_publisher(self) -> None:
        """Make the stop due now, because the topic's last publisher has left.

        Nothing changes if a stop was sent already.
        """
        with self._lock:
            # While the topic is silent, the stop has been sent already and is repeated anyway.
            if not self._silent:
                self._due = -math.inf

    def is_due(self, now: float) -> bool:
        """Return true if the stop must be sent now; the caller then has to send it."""
        with self._lock:
            if now < self._due:
                return False
            self._silent, self._due = True, now + self._repeat_s
            return True
