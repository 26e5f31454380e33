"""Statistics of a link, from the link messages of one sender: loss, order, jitter, delay and clock offset.

- Loss compares how many datagrams the sender says it sent with how many arrived. All datagrams count, not only link
  messages. A datagram that arrives twice hides a lost one.
- Order and duplicates are those of the link messages, because only they are numbered.
- The jitter is that of RFC 3550, section 6.4.1, of the link messages.
- Round-trip time and clock offset are those of NTP (RFC 5905, section 8): of the last eight exchanges, the one with the
  shortest round trip counts, because queues delay the others.

Times are in microseconds. Counters of the sender have 32 bits and start again at 0.
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from roverlink.runtime.core.link_message import LinkMessage

_BITS = 2**32
_WINDOW = 16  # link messages over which the recent loss is computed
_SAMPLES = 8  # RFC 5905, section 10: stages of the clock filter
_REMEMBERED = 64  # sequence numbers; an older one that comes late is taken for a duplicate
_EXCHANGES = 64  # about a minute, so that some of them find no queue
_JUMP_US = 60_000_000  # a difference of transit times above it is a jump of the sender's clock
_TOLERANCE_US = 1000  # round trips may seem negative by this much, because two clocks never run equally fast


class _Sample(NamedTuple):
    """Exchange of two link messages."""

    round_trip_us: int
    offset_us: int


class Exchange(NamedTuple):
    """Two link messages: one to the sender, and one of the sender that answers it. Times are in microseconds."""

    sent: int
    received_there: int
    """Time on the clock of the other end, as the next one."""
    sent_there: int
    arrived: int


class LossCount:
    """Count of lost datagrams, from the number that was sent and the number that arrived, both since some moment."""

    def __init__(self) -> None:
        self._first: tuple[int, int] | None = None
        self._points: deque[tuple[int, int]] = deque(maxlen=_WINDOW + 1)

    def update(self, sent: int, arrived: int) -> None:
        """Take the present numbers. They never decrease."""
        if self._first is None:
            self._first = sent, arrived
        self._points.append((sent, arrived))

    @property
    def lost(self) -> int:
        """Datagrams lost since the first call of `update`."""
        return _lost(self._first, self._points[-1])[0] if self._first else 0

    @property
    def recent(self) -> float | None:
        """Share of the datagrams of the last 16 link messages that was lost, from 0 to 1; None if none was sent."""
        if not self._points:
            return None
        lost, sent = _lost(self._points[0], self._points[-1])
        return lost / sent if sent else None


def _lost(before: tuple[int, int], now: tuple[int, int]) -> tuple[int, int]:
    """Return how many datagrams were lost, and how many were sent."""
    sent = now[0] - before[0]
    # More arrive than were sent if datagrams arrive twice, or overtake a link message.
    return max(0, sent - (now[1] - before[1])), sent


class LinkStatistics:
    """Statistics of the link messages of one sender, from one start of it to the next."""

    def __init__(self) -> None:
        self.messages = 0
        """Link messages that arrived, without duplicates."""
        self.duplicates = 0
        self.reordered = 0
        """Link messages that arrived after a later one."""
        self.inbound = LossCount()
        """Loss of the sender's datagrams."""
        self.outbound = LossCount()
        """Loss of the datagrams to the sender, as the sender tells."""
        self._jitter_us: float | None = None
        self._newest = 0  # sequence number without the limit of 32 bits
        self._seen: deque[int] = deque(maxlen=_REMEMBERED)
        self._sent = self._received_there = 0
        self._transit_us: int | None = None
        self._echo_us = 0
        self._samples: deque[_Sample] = deque(maxlen=_SAMPLES)
        self.exchanges: deque[Exchange] = deque(maxlen=_EXCHANGES)
        """Last exchanges, the oldest one first."""

    @property
    def jitter_us(self) -> float | None:
        """Mean deviation of the time that link messages need, in microseconds; None before the second one."""
        return self._jitter_us

    @property
    def round_trip_us(self) -> int | None:
        """Time for the way there and back, without the time in the other program; None if no exchange was complete."""
        return min(self._samples).round_trip_us if self._samples else None

    @property
    def clock_offset_us(self) -> int | None:
        """Sender's clock minus the own one; None if no exchange was complete."""
        return min(self._samples).offset_us if self._samples else None

    def __repr__(self) -> str:
        figures = {
            "messages": self.messages,
            "lost_inbound": self.inbound.lost,
            "lost_outbound": self.outbound.lost,
            "duplicates": self.duplicates,
            "reordered": self.reordered,
            "jitter_us": None if self.jitter_us is None else round(self.jitter_us),
            "round_trip_us": self.round_trip_us,
            "clock_offset_us": self.clock_offset_us,
        }
        return f"{type(self).__name__}({', '.join(f'{name}={value}' for name, value in figures.items())})"

    def is_duplicate(self, message: LinkMessage) -> bool:
        """Return true if the message has arrived before."""
        return bool(self.messages) and (
            (sequence := self._unwrapped(message.sequence)) in self._seen or sequence <= self._newest - _REMEMBERED
        )

    def take(self, message: LinkMessage, arrived_us: int, received: int, sent_before_echo: int | None) -> None:
        """Take a link message of the sender.

        ``received`` is the number of the sender's datagrams that had arrived before. ``sent_before_echo`` is the number
        of datagrams that had been sent to the sender before the link message that this one answers; None if it answers
        none that is known.
        """
        if self.is_duplicate(message):
            self.duplicates += 1
            return
        self._take_time(message, arrived_us)
        sequence = self._unwrapped(message.sequence) if self.messages else message.sequence
        self.messages += 1
        self._seen.append(sequence)
        if self.messages > 1 and sequence < self._newest:
            self.reordered += 1
            return  # its counters and its echo are old
        self._newest = sequence
        self._sent += _difference(message.sent, self._sent)
        self.inbound.update(self._sent, received)
        if sent_before_echo is not None and message.echo_us != self._echo_us:
            self._echo_us = message.echo_us
            self._received_there += _difference(message.received, self._received_there)
            self.outbound.update(sent_before_echo, self._received_there)
            self._take_exchange(message, arrived_us)

    def _unwrapped(self, sequence: int) -> int:
        return self._newest + _difference(sequence, self._newest)

    def _take_time(self, message: LinkMessage, arrived_us: int) -> None:
        transit_us = arrived_us - message.time_us  # includes the unknown difference of the clocks
        if self._transit_us is not None:
            change_us = abs(transit_us - self._transit_us)
            if change_us > _JUMP_US:
                self._samples.clear()
                self.exchanges.clear()
            else:
                self._jitter_us = (self._jitter_us or 0.0) + (change_us - (self._jitter_us or 0.0)) / 16
        self._transit_us = transit_us

    def _take_exchange(self, message: LinkMessage, arrived_us: int) -> None:
        """Take the four times of an exchange; RFC 5905 calls them T1 to T4."""
        sent_us, received_there_us = message.echo_us, message.time_us - message.echo_age_us
        round_trip_us = (arrived_us - sent_us) - message.echo_age_us
        if round_trip_us >= -_TOLERANCE_US:
            offset_us = ((received_there_us - sent_us) + (message.time_us - arrived_us)) // 2
            self._samples.append(_Sample(max(0, round_trip_us), offset_us))
            self.exchanges.append(Exchange(sent_us, received_there_us, message.time_us, arrived_us))


def _difference(counter: int, before: int) -> int:
    """Return the signed difference of a 32-bit counter to an earlier value of it, which may have any number of bits."""
    return (counter - before + _BITS // 2) % _BITS - _BITS // 2
