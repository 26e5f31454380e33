"""Watchdog of a topic that commands a peer (table key ``deadman``): decides when the bridge must send the stop.

The stop is the datagram that the table gives under ``deadman``; it makes the peer stop. A topic is silent if no message
of it has been sent to the peer for some time. The cause does not matter: the publisher hangs, was killed or has left;
its messages cannot be converted; or the thread that receives them is blocked. At start the topic counts as silent,
because nobody knows which command the peer got before.

Times are arguments, in seconds of a monotonic clock.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable


class Watchdog:
    """Watchdog of one topic: decides when the bridge must send the stop, a datagram that makes the peer stop.

    Safe to call from several threads.
    """

    def __init__(self, after_s: float, repeat_s: float, now: float) -> None:
        """Set the times: the stop is due after ``after_s`` seconds of silence, and then every ``repeat_s`` seconds."""
        self._after_s, self._repeat_s = after_s, repeat_s
        self._due = now + after_s
        self._silent = True
        self._passed = -math.inf
        self._lock = threading.Lock()
        self.last_sent: Callable[[], float] = lambda: -math.inf
        """Function that returns when the native core last sent a message of the topic to the peer."""

    @property
    def silent(self) -> bool:
        """True if no message of the topic has been sent to the peer since the last stop, or since the start."""
        with self._lock:
            self._note_last_sent()
            return self._silent

    @property
    def next_due(self) -> float:
        """Time at which `is_due` becomes true if no message is sent to the peer before."""
        with self._lock:
            self._note_last_sent()
            return self._due

    def message_passed(self, now: float) -> None:
        """Record that a message was sent to the peer at the time ``now``; this restarts the time of silence."""
        with self._lock:
            self._silent, self._due = False, now + self._after_s

    def _note_last_sent(self) -> None:
        """Record what the native core has sent since the last call. The caller holds the lock."""
        if (sent := self.last_sent()) > self._passed:
            self._passed, self._silent, self._due = sent, False, sent + self._after_s

    def lost_publisher(self) -> None:
        """Make the stop due now, because the topic's last publisher has left.

        Nothing changes while the topic is silent, because the stop is then being repeated anyway.
        """
        with self._lock:
            self._note_last_sent()
            # While the topic is silent, the stop has been sent already and is repeated anyway.
            if not self._silent:
                self._due = -math.inf

    def is_due(self, now: float) -> bool:
        """Return true if the caller must send the stop now; the watchdog then counts the stop as sent."""
        with self._lock:
            self._note_last_sent()
            if now < self._due:
                return False
            self._silent, self._due = True, now + self._repeat_s
            return True
