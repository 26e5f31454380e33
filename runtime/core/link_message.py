"""Link message: what one end of a link tells the other one about once a second, and the state from which it is written.

The generated .proto file of the link message explains its fields. Times are in microseconds of a clock that never jumps
(a monotonic clock, which may start anywhere). Counters on the wire have 32 bits and start again at 0 after the largest.
"""

from __future__ import annotations

import secrets
import threading
from collections import OrderedDict
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage

    from roverlink.runtime.core.registry import EndName, Registry

NAME = "link"
"""Name of the link message's member in the envelope's oneof."""
PERIOD_S = 1.0
"""Interval in seconds at which each end sends a link message."""
_ROWS = 8  # most rows in one link message, as its .proto file says
_REMEMBERED = 64  # own link messages whose echo is recognized
_LARGEST = 2**32


class LinkMessage(NamedTuple):
    """Link message that was received."""

    session: int
    sequence: int
    sent: int
    received: int
    time_us: int
    echo_us: int
    echo_age_us: int
    hashes: Mapping[int, int]
    """Hash of the wire schema of each payload in the message, by the payload's number."""


def read(payload: ProtoMessage) -> LinkMessage:
    """Return the content of a parsed link message."""
    link: Any = payload
    return LinkMessage(
        link.session,
        link.sequence,
        link.sent,
        link.received,
        link.time_us,
        link.echo_us,
        link.echo_age_us,
        dict(zip(link.numbers, link.hashes)),
    )


def rows_in_turn(registry: Registry, end: EndName) -> list[int]:
    """Return the numbers of the rows that an end speaks, in the order in which its link messages tell them.

    The rows that it sends or receives itself come first, because they tell who the sender is. The rows that are
    forwarded to it follow. Otherwise they are in the order of the registry.
    """
    routes = [handler.route for handler in registry.handlers]
    own = [route.number for route in routes if route.peer == end.peer and end.board in ("", route.board)]
    gets_forwarded = not end.board or end in registry.ends  # otherwise the datagrams go to its peer
    forwarded = [route.number for route in routes if route.inbound and end.peer in route.forward and gets_forwarded]
    return list(dict.fromkeys([*own, *forwarded]))


def new_session() -> int:
    """Return a random number that identifies one run of a program; never 0."""
    return secrets.randbelow(_LARGEST - 1) + 1


class _Heard(NamedTuple):
    """Last link message that was received."""

    time_us: int
    arrived_us: int
    received: int


class LinkWriter:
    """Writer of the link messages to one receiver. Safe to use from several threads."""

    def __init__(self, envelope: type[ProtoMessage], session: int, hashes: Mapping[int, int]) -> None:
        """Tell the ``hashes`` of payloads, given by the payloads' numbers, in their order.

        ``envelope`` is the class of the envelope. ``session`` is a result of `new_session`.
        """
        self._envelope, self._session, self._hashes = envelope, session, list(hashes.items())
        self._next_row = 0
        self._sequence = 0
        self._sent = 0
        self._heard: _Heard | None = None
        self._written: OrderedDict[int, int] = OrderedDict()  # time of each link message, and `sent` in it
        self._lock = threading.Lock()

    @property
    def turns(self) -> int:
        """Number of link messages that are needed to tell the hashes of all rows."""
        return max(1, -(-len(self._hashes) // _ROWS))

    def count_sent(self, datagrams: int) -> None:
        """Count datagrams to the receiver that are not link messages."""
        with self._lock:
            self._sent += datagrams

    def note_heard(self, message: LinkMessage, arrived_us: int, received: int) -> None:
        """Take a link message of the receiver, so that the next link message answers it.

        ``received`` is the number of datagrams that had been received from it before this one.
        """
        self._heard = _Heard(message.time_us, arrived_us, received)

    def sent_before(self, echo_us: int) -> int | None:
        """Return how many datagrams were sent before the link message of the time ``echo_us``.

        Return None if none of the last link messages has this time, so that an echo of it has no meaning.
        """
        return self._written.get(echo_us)

    def write(self, now_us: int) -> bytes:
        """Return an envelope with the next link message, and count it as sent."""
        with self._lock:
            heard, sent = self._heard, self._sent
            self._sent += 1
            self._sequence += 1
            # Two messages with one time could not be told apart by their echoes.
            now_us = max(now_us, next(reversed(self._written), -1) + 1)
            self._written[now_us] = sent
            if len(self._written) > _REMEMBERED:
                self._written.popitem(last=False)
            rows = self._hashes[self._next_row : self._next_row + _ROWS]
            self._next_row = 0 if self._next_row + _ROWS >= len(self._hashes) else self._next_row + _ROWS
            sequence = self._sequence
        link = {
            "session": self._session,
            "sequence": sequence % _LARGEST,
            "sent": sent % _LARGEST,
            "received": (heard.received if heard else 0) % _LARGEST,
            "time_us": now_us,
            "echo_us": heard.time_us if heard else 0,
            "echo_age_us": min(now_us - heard.arrived_us, _LARGEST - 1) if heard else 0,
            "numbers": [number for number, _ in rows],
            "hashes": [hash for _, hash in rows],
        }
        return self._envelope(**{NAME: link}).SerializeToString()
