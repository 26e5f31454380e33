"""Requests that are repeated until they are answered, and responses that are repeated instead of a second execution.

Nothing here uses a thread or a clock: the time is an argument, in seconds of any clock that only goes forward.

- A request with a correlation field has a number, which the response repeats; 64 requests may be under way at a time.
  Without the field, it is one, and the next one waits. If the last request was sent more often than it was answered,
  another response may come, so the next one waits for one more timeout.
- The waits between two sendings of a request are one, two, four and again four timeouts. If 30 %
  of all datagrams are lost each way, four sendings answer 93 % of the requests, five 97 % and ten 99.9 %. The caller of
  a request without a response hears so.
- The receiver knows a repeated request by its bytes, which contain the number. It remembers a request for as long as
  its sender may repeat it.
"""

from __future__ import annotations

import math
import random
from collections import OrderedDict, deque
from dataclasses import dataclass
from enum import Enum, auto
from hashlib import blake2b
from typing import Generic, TypeVar

from roverlink.runtime.core.handler import RowRequest

C = TypeVar("C")

LARGEST_NUMBER = 2**31 - 1
"""Largest number of a request: every integer type of protobuf holds it."""
_LONGEST_WAIT = 4  # timeouts
_MOST_UNDER_WAY = 64  # a burst of requests must not fill the link
_MOST_WAITING = 1000
_MOST_REMEMBERED = 4096  # with the default settings, 546 requests a second


def lifetime(request: RowRequest) -> float:
    """Return the seconds from the first sending of a request until it counts as unanswered."""
    return sum((_wait(request, attempt) for attempt in range(request.attempts)), 0.0)


def _wait(request: RowRequest, attempt: int) -> float:
    return request.timeout_ms / 1000 * min(1 << attempt, _LONGEST_WAIT)


class Fate(Enum):
    """Fate of a response that belongs to no waiting caller, and of a request that was received before."""

    UNKNOWN = auto()
    """Nobody has asked for the response; or the request is new."""
    REPEATED = auto()
    """The response has come before, or too late; or the request was received before, and has no response yet."""


@dataclass(slots=True)
class _Waiting(Generic[C]):
    """Request that has no response yet."""

    number: int
    datagram: bytes
    caller: C
    attempts: int = 0
    due: float = -math.inf


class Repeater(Generic[C]):
    """Sender of the requests of one row: it repeats them, and finds the caller to whom a response belongs."""

    def __init__(self, request: RowRequest, first: int | None = None) -> None:
        """Create a repeater without requests; ``first`` is the number of its first request, else a random one."""
        self._request, self._one_at_a_time = request, not request.field
        self._most_under_way = _MOST_UNDER_WAY if request.field else 1
        # Random, so that a program that starts again does not use the numbers of before.
        self._number = (random.randrange(LARGEST_NUMBER) if first is None else first - 1) % LARGEST_NUMBER  # noqa: S311
        self._under_way: dict[int, _Waiting[C]] = {}
        self._queue: deque[_Waiting[C]] = deque()
        self._ended: OrderedDict[int, float] = OrderedDict()
        self._quiet_until = -math.inf

    @property
    def is_full(self) -> bool:
        """True if so many requests wait that no other one may be added."""
        return len(self._under_way) + len(self._queue) >= _MOST_WAITING

    def new_number(self) -> int:
        """Return the number of the next request, from 1 to `LARGEST_NUMBER`; no request of the last time has it."""
        self._number = self._number % LARGEST_NUMBER + 1
        while self._number in self._under_way or self._number in self._ended:
            self._number = self._number % LARGEST_NUMBER + 1
        return self._number

    def add(self, number: int, datagram: bytes, caller: C) -> None:
        """Add a request with a number of `new_number`. It is due at once, or when the one before it has ended."""
        self._queue.append(_Waiting(number, datagram, caller))

    @property
    def next_due(self) -> float:
        """Time at which `take_due` has something to do; infinity if nothing waits."""
        due = min((one.due for one in self._under_way.values()), default=math.inf)
        if self._queue and len(self._under_way) < self._most_under_way:
            due = min(due, self._quiet_until)
        return due

    def take_due(self, now: float) -> tuple[list[tuple[bytes, bool]], list[C]]:
        """Return the datagrams to send now, each with true if it is sent again, and the callers without a response."""
        unanswered = []
        for one in [one for one in self._under_way.values() if one.due <= now]:
            if one.attempts == self._request.attempts:
                self._end(one, now)
                unanswered.append(one.caller)
        while self._queue and len(self._under_way) < self._most_under_way and self._quiet_until <= now:
            one = self._queue.popleft()
            self._under_way[one.number] = one
        due = [one for one in self._under_way.values() if one.due <= now]
        datagrams = [(one.datagram, one.attempts > 0) for one in due]
        for one in due:
            one.due = now + _wait(self._request, one.attempts)
            one.attempts += 1
        return datagrams, unanswered

    def answered(self, number: int, now: float) -> C | Fate:
        """Return the caller to whom a response belongs, who must get it; otherwise the fate of the response.

        ``number`` is ignored if the request has no correlation field.
        """
        if self._one_at_a_time:
            number = next(iter(self._under_way), 0)
        one = self._under_way.get(number)
        if one is None:
            is_late = now < self._quiet_until if self._one_at_a_time else now < self._ended.get(number, -math.inf)
            return Fate.REPEATED if is_late else Fate.UNKNOWN
        self._end(one, now, responses=1)
        return one.caller

    def cancel(self, caller: C, now: float) -> None:
        """Forget the request of a caller, which wants no response any more."""
        self._queue = deque(one for one in self._queue if one.caller is not caller)
        for one in [one for one in self._under_way.values() if one.caller is caller]:
            self._end(one, now)

    def withdraw(self) -> list[tuple[C, bool]]:
        """Forget all requests. Return their callers, who get no response any more, each with true if it was sent."""
        callers = [(one.caller, one.attempts > 0) for one in (*self._under_way.values(), *self._queue)]
        self._under_way.clear()
        self._queue.clear()
        return callers

    def _end(self, one: _Waiting[C], now: float, responses: int = 0) -> None:
        del self._under_way[one.number]
        if self._one_at_a_time and one.attempts > responses:
            self._quiet_until = now + self._request.timeout_ms / 1000
        self._ended[one.number] = now + lifetime(self._request)
        while self._ended and (len(self._ended) > _MOST_WAITING or next(iter(self._ended.values())) <= now):
            self._ended.popitem(last=False)


@dataclass(slots=True)
class _Known:
    """Request that was received."""

    number: int
    until: float
    response: bytes | None = None


class Responses:
    """Receiver of the requests of one row: it knows which ones it has passed on, and stores their responses."""

    def __init__(self, request: RowRequest) -> None:
        self._request = request
        self._known: OrderedDict[bytes, _Known] = OrderedDict()  # by the hash of the request

    def take(self, request: bytes, number: int, now: float) -> bytes | Fate:
        """Return the stored response to a request; otherwise its fate.

        A request that is `Fate.UNKNOWN` must be passed on, and is known from now on. ``number`` is that of its
        correlation field; 0 without one. A sender that does not fill the field gets every request passed on.
        """
        if self._request.field and not number:
            return Fate.UNKNOWN
        while self._known and next(iter(self._known.values())).until <= now:
            self._known.popitem(last=False)
        key = _hash(request)
        if (known := self._known.get(key)) is not None:
            return Fate.REPEATED if known.response is None else known.response
        self._known[key] = _Known(number, now + lifetime(self._request))
        if len(self._known) > _MOST_REMEMBERED:
            self._known.popitem(last=False)
        return Fate.UNKNOWN

    def store(self, number: int, response: bytes) -> None:
        """Store the response to the newest request with a number, or without a correlation field to the newest one.

        A second response to the same request is not stored.
        """
        for known in reversed(self._known.values()):
            if not self._request.field or known.number == number:
                known.response = known.response or response
                return

    def forget(self, request: bytes) -> None:
        """Forget a request that could not be passed on, so that it is passed on when it comes again."""
        self._known.pop(_hash(request), None)


def _hash(request: bytes) -> bytes:
    return blake2b(request, digest_size=16).digest()
