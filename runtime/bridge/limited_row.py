"""Limits of a row: which messages pass, and when the last one passes again.

The table keys are ``max_rate``, ``on_change`` and ``at_least``. Times are in seconds of the monotonic clock.
"""

from __future__ import annotations

import ctypes
import math
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

from roverlink.runtime.core.handler import SendLimits
from roverlink.runtime.core.wire_format import fields
from roverlink.runtime.native.shared_lock import SharedLock

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
        self._expects = False
        self._lock = threading.Lock()

    def lend(self, lock: int | None) -> int:
        """Let the native core use the memory under a lock. Return the address of the memory."""
        self._memory = ctypes.create_string_buffer(_ROOM)
        self.room, self.message, self.shared_lock = _ROOM, ctypes.addressof(self._memory), lock
        return ctypes.addressof(self)

    @property
    def next_slot(self) -> float | None:
        """Time at which the waiting message may pass; None if no message waits.

        After a message that has waited, it is the time of the next one, too, which will mostly come to wait.
        """
        return self.slot if self.waits or self._expects else None

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
            if now < self.slot:
                return None
            self._expects = bool(self.waits)
            if self._expects:
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
        """Let the next datagram pass, because the network has refused one."""
        self._content = None

    def renew(self) -> None:
        """Let `again` have the last datagram now. Safe to call from any thread."""
        if self._last is not None:
            self.next_due = -math.inf

    def again(self, now: float) -> bytes | None:
        """Return the last datagram if nothing was sent for too long, or after `renew`."""
        if now < self.next_due or self._last is None:
            return None
        self._content, self.next_due = self._without_signature(self._last), now + self._interval
        return self._last

    def _without_signature(self, datagram: bytes) -> bytes:
        if self._signature is None:
            return datagram
        start, rest = 0, b""
        for field in fields(datagram):
            rest += datagram[start : field.end] if field.number != self._signature else b""
            start = field.end
        return rest


class LimitedRow(ABC):
    """Path of a row's messages or datagrams to one receiver, with limits. A `TimedTask`.

    Used from the thread that takes the messages and from the timekeeper's thread. A lock keeps the messages in order.
    """

    def __init__(self, limits: SendLimits, signature: int | None = None) -> None:
        """``signature`` is the number of the envelope's field with a signature, if the datagrams have one."""
        self.pacer = Pacer(limits.max_rate) if limits.max_rate else None
        """Limit of the rate; None without one."""
        self.changes = Changes(limits, signature) if limits.on_change or limits.at_least_ms else None
        """Choice of the datagrams that the rate lets pass; None if all pass."""
        self.lock: threading.Lock | SharedLock = threading.Lock()
        """Lock to hold while messages are limited and passed on."""
        self.wake: Callable[[], None] = lambda: None
        """Function that wakes the timekeeper of this row."""

    @property
    def is_limited(self) -> bool:
        """True if the row has limits, so that a `Timekeeper` has to run it."""
        return self.pacer is not None or self.changes is not None

    def take(self, messages: Sequence[bytes]) -> None:
        """Pass on the messages that the limits let pass. The newest one may have to wait; the others are counted."""
        with self.lock:
            due = self._next_pass
            self._take(messages)
            is_earlier = self._next_pass < due
        # Outside of the lock, because `wake` makes the timekeeper take the lock at once.
        if is_earlier:
            self.wake()

    def _take(self, messages: Sequence[bytes]) -> None:
        """Do the work of `take`; the caller holds the lock."""
        if self.pacer is not None:
            messages, superseded = self.pacer.offer(messages, time.monotonic())
            self._count_superseded(superseded)
        if messages:
            self._pass_on(messages)

    def run_due(self, now: float) -> None:
        """Pass on the waiting message if its time has come, or the last datagram again."""
        # If the lock is taken, the other thread passes something on right now; the next round looks again.
        if self._next_pass < math.inf and self.lock.acquire(blocking=False):
            try:
                if self.pacer is not None and (waited := self.pacer.take(now)) is not None:
                    self._pass_on([waited])
                elif self.changes is not None and (last := self.changes.again(now)) and not self._repeat(last):
                    self._not_sent()
            finally:
                self.lock.release()

    @property
    def next_due(self) -> float:
        """Time at which `run_due` has something to do, unless a message comes before; infinity for never."""
        return self._next_pass

    @property
    def _next_pass(self) -> float:
        """Time at which the waiting message, or the last datagram again, may pass; infinity for never."""
        slot = self.pacer.next_slot if self.pacer is not None else None
        again = self.changes.next_due if self.changes is not None else math.inf
        return again if slot is None else min(slot, again)

    def renew(self) -> None:
        """Pass the last datagram on once more, because the receiver may not have it: it may have started again."""
        if self.changes is not None:
            self.changes.renew()
            self.wake()

    def end(self) -> None:
        """Pass on the waiting message. Call it when no more messages come."""
        if self.pacer is not None and (waited := self.pacer.withdraw()) is not None:
            self._pass_on([waited])

    def _changed(self, datagrams: Sequence[bytes]) -> Sequence[bytes]:
        """Return the datagrams that `changes` lets pass."""
        return datagrams if self.changes is None else self.changes.choose(datagrams, time.monotonic())

    def _not_sent(self) -> None:
        """Let the next datagram pass even if it is equal, because the network has refused one."""
        if self.changes is not None:
            self.changes.not_sent()

    @abstractmethod
    def _count_superseded(self, count: int) -> None:
        """Count messages that newer ones have replaced."""

    @abstractmethod
    def _pass_on(self, messages: Sequence[bytes]) -> None:
        """Pass messages on; the caller holds the lock."""

    @abstractmethod
    def _repeat(self, datagram: bytes) -> int:
        """Pass the last datagram on once more, and return how many were sent; the caller holds the lock."""
