"""Choice of the messages of a row that are passed on (table keys ``max_rate``, ``on_change`` and ``at_least``).

Times are arguments, in seconds of a monotonic clock.
"""

from __future__ import annotations

import ctypes
import math
import threading
from collections.abc import Sequence

from roverlink.runtime.core.handler import SendLimits
from roverlink.runtime.core.wire_format import fields

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


class Changes:
    """Choice of the datagrams that an end gets of one row: only changes, and the last one again if there is none."""

    def __init__(self, limits: SendLimits, signature: int | None) -> None:
        """``signature`` is the number of the envelope's field with a signature, which is new in each datagram."""
        self._on_change, self._signature = limits.on_change, signature
        self._interval = math.inf if limits.at_least_ms is None else limits.at_least_ms / 1000
        self._last: bytes | None = None
        self._content: bytes | None = None
        self.next_due = math.inf
        """Time at which `again` has the last datagram; infinity for never."""

    def choose(self, datagrams: Sequence[bytes], now: float) -> list[bytes]:
        """Return the datagrams to send of those that have come."""
        chosen = []
        for datagram in datagrams:
            content = self._without_signature(datagram)
            if self._on_change and content == self._content and now < self.next_due:
                continue
            self._last, self._content, self.next_due = datagram, content, now + self._interval
            chosen.append(datagram)
        return chosen

    def not_sent(self) -> None:
        """Let the next datagram pass, because the network has refused one that was chosen."""
        self._content = None

    def again(self, now: float) -> bytes | None:
        """Return the last datagram if nothing was sent for too long."""
        if now < self.next_due:
            return None
        self.next_due = now + self._interval
        return self._last

    def _without_signature(self, datagram: bytes) -> bytes:
        if self._signature is None:
            return datagram
        start, rest = 0, b""
        for field in fields(datagram):
            rest += datagram[start : field.end] if field.number != self._signature else b""
            start = field.end
        return rest
