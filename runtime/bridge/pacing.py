"""Rate limit for the messages of a row (table key ``max_rate``).

Times are arguments, in seconds of a monotonic clock.
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Sequence

_ROOM = 1 << 16


class Pacer(ctypes.Structure):
    """Rate limit for the messages of one row. Safe to call from several threads.

    A message that comes too early waits until its time; a newer message replaces a waiting one. The native core uses
    the memory, too, under the lock of the row (`rl_pacer` in bridge.h).
    """

    _fields_ = (
        ("interval", ctypes.c_double),
        ("slot", ctypes.c_double),
        ("waits", ctypes.c_uint64),
        ("size", ctypes.c_uint64),
        ("room", ctypes.c_uint64),
        ("message", ctypes.c_void_p),
        ("shared_lock", ctypes.c_void_p),
        ("superseded", ctypes.c_uint64),
    )
    interval: float
    slot: float
    waits: int
    size: int
    superseded: int
    """Messages that a newer one has replaced in the native core."""

    def __init__(self, rate: float) -> None:
        """Let at most ``rate`` messages a second pass."""
        super().__init__(1 / rate)
        self._kept = b""
        self._lock = threading.Lock()

    def lend(self, lock: int | None) -> int:
        """Let the native core use the memory under a lock. Return the address of the memory."""
        self._memory = ctypes.create_string_buffer(_ROOM)
        self.room, self.message, self.shared_lock = _ROOM, ctypes.addressof(self._memory), lock
        return ctypes.addressof(self)

    @property
    def next_slot(self) -> float | None:
        """Time at which the waiting message may pass; None if no message waits."""
        return self.slot if self.waits else None

    def offer(self, messages: Sequence[bytes], now: float) -> tuple[Sequence[bytes], int]:
        """Return the newest message in a sequence if it may pass now; otherwise it waits for `take`.

        Return also how many messages it has superseded: those before it, and one that waited.
        """
        with self._lock:
            superseded = len(messages) - 1 + self.waits
            if now < self.slot:
                self.waits, self.size, self._kept = 1, 0, messages[-1]
                return (), superseded
            # From now and not from the last slot: after a pause, a burst must not catch up.
            self.waits, self.slot = 0, now + self.interval
            return messages[-1:], superseded

    def take(self, now: float) -> bytes | None:
        """Return the waiting message if it may pass now; None if it must still wait, or if no message waits."""
        with self._lock:
            if now < self.slot or not self.waits:
                return None
            self.slot = now + self.interval
            return self._withdrawn()

    def withdraw(self) -> bytes | None:
        """Remove and return the waiting message; None if no message waits."""
        with self._lock:
            return self._withdrawn()

    def _withdrawn(self) -> bytes | None:
        waits, self.waits = self.waits, 0
        if not waits:
            return None
        return self._memory.raw[: self.size] if self.size else self._kept
