"""Counters of a bridge: datagrams and messages received, sent and dropped, with the reason of each drop."""

from __future__ import annotations

import logging
import threading
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from roverlink.numerals import counted

WARNING_INTERVAL_S = 2.0


@dataclass
class Account:
    """Counters of a bridge since its start.

    `Counters` updates them; monitoring and the final summary read them. Each counter is written by one thread, or under
    a lock. Another thread that reads a counter may get a value that is slightly old. Counters "by payload" use the
    payload's field name in the envelope's oneof.
    """

    received: int = 0
    """Datagrams read from the socket."""
    published: Counter[str] = field(default_factory=Counter)
    """Messages published on the rows' own topics, or given to the row's service (`request`), by payload."""
    extra_published: Counter[str] = field(default_factory=Counter)
    """Messages published on extra topics, by topic."""
    extra_unpublished: Counter[str] = field(default_factory=Counter)
    """Messages of extra topics that did not fit, or that the middleware did not accept, by topic."""
    sent: Counter[str] = field(default_factory=Counter)
    """Datagrams sent to peers, made from messages of topics, by payload."""
    forwarded: Counter[str] = field(default_factory=Counter)
    """Received datagrams that were sent on to another peer, by this peer."""
    dropped: Counter[str] = field(default_factory=Counter)
    """Datagrams received but not bridged, by reason (`Reason`)."""
    dropped_of_row: Counter[tuple[str, str]] = field(default_factory=Counter)
    """Dropped datagrams whose payload is known, by payload and reason."""
    clocks_ahead: Counter[str] = field(default_factory=Counter)
    """Signed datagrams that were accepted more than a minute ahead of this computer's clock, by who signed them."""
    unsent: Counter[str] = field(default_factory=Counter)
    """Datagrams that the network refused to send, by peer."""
    undelivered: Counter[tuple[str, str, str]] = field(default_factory=Counter)
    """Datagrams that were sent to an end, but did not leave: for its line, or its budget. By peer, board and reason.

    They count as sent or forwarded, too. The reasons are those of `Undelivered`.
    """
    undelivered_of_row: Counter[tuple[str, str]] = field(default_factory=Counter)
    """Datagrams that did not leave because of a budget, by payload and reason."""
    damaged: Counter[tuple[str, str]] = field(default_factory=Counter)
    """Frames that were damaged on the line of an end, so that nothing was received, by peer and board."""
    unforwarded: Counter[str] = field(default_factory=Counter)
    """Datagrams not forwarded to a peer, by this peer: longer than its ``max_size``, or of another schema."""
    withheld: Counter[tuple[str, str, str]] = field(default_factory=Counter)
    """Datagrams that were not forwarded to a peer because of the limits under `forward`.

    By peer, payload and reason: ``superseded`` (a newer one replaced it) or ``unchanged``.
    """
    repeated: Counter[str] = field(default_factory=Counter)
    """Datagrams that were sent again, by payload: for want of a new one (``at_least``), or of a ``request``."""
    budget_bytes: Counter[str] = field(default_factory=Counter)
    """Bytes sent to a peer with a ``budget``, with the headers of IP and UDP, by peer."""
    link_events: Counter[tuple[str, str, str]] = field(default_factory=Counter)
    """Events of the addresses of peers, by peer, board (empty for a whole peer) and event (`LinkEvent`)."""
    links_received: int = 0
    """Link messages received from peers."""
    links_sent: Counter[str] = field(default_factory=Counter)
    """Link messages sent, by peer."""
    other_schemas: Mapping[str, Sequence[str]] = field(default_factory=dict)
    """Names of the rows whose schema differs now at an end, by the end's name."""
    taken: Counter[str] = field(default_factory=Counter)
    """Messages received from topics, by payload."""
    refused: Counter[str] = field(default_factory=Counter)
    """Messages of topics that could not be converted to a datagram, by payload."""
    superseded: Counter[str] = field(default_factory=Counter)
    """Messages of topics that a newer message replaced before they were sent (``max_rate``), by payload."""
    unchanged: Counter[str] = field(default_factory=Counter)
    """Messages of topics that were not sent because the last one had the same payload (``on_change``), by payload."""
    late: Counter[str] = field(default_factory=Counter)
    """Messages of topics that were not sent because they came more than a second late (over zenoh), by payload."""
    failed: Counter[str] = field(default_factory=Counter)
    """Messages of topics whose datagram the network refused, by payload."""
    stops: Counter[str] = field(default_factory=Counter)
    """Stop datagrams that the bridge sent on its own because a topic was silent, by payload."""
    # Times of the last message that was published or sent, and of the last stop, by payload, in seconds of the
    # monotonic clock. They are no counters, so the table of the docs has none of them.
    last_crossed: dict[str, float] = field(default_factory=dict)
    last_stops: dict[str, float] = field(default_factory=dict)
    unanswered: Counter[str] = field(default_factory=Counter)
    """Calls of a service whose request the peer has not answered (`request`), by payload."""
    qos_mismatches: Mapping[str, Sequence[str]] = field(default_factory=dict)
    """Texts about publishers and subscriptions of other nodes whose QoS does not match now, by topic in the table."""
    kernel_drops: int = 0
    """Datagrams that the kernel dropped because the socket's receive buffer was full."""
    standing: dict[str, str] = field(default_factory=dict)
    """Texts about what is wrong now and lasts, such as generated code of another table, by subject."""

    def count_published(self, name: str, count: int) -> None:
        """Count messages of a row that were published now."""
        _count(self.published, self.last_crossed, name, count)

    def count_sent(self, name: str, count: int) -> None:
        """Count datagrams of a row that were sent now."""
        _count(self.sent, self.last_crossed, name, count)

    def count_stops(self, name: str, count: int) -> None:
        """Count stops of a row that were sent now."""
        _count(self.stops, self.last_stops, name, count)

    def as_dict(self) -> dict[str, Any]:
        """Return the counters as plain values, for JSON."""
        return {
            "received": self.received,
            "published": self.published.total(),
            "sent": self.sent.total(),
            "forwarded": self.forwarded.total(),
            "dropped": {reason: count for reason, count in sorted(self.dropped.items()) if count},
            "taken": self.taken.total(),
            "refused": dict(sorted(self.refused.items())),
            "superseded": dict(sorted(self.superseded.items())),
            "unchanged": dict(sorted(self.unchanged.items())),
            "late": {name: count for name, count in sorted(self.late.items()) if count},
            "failed": dict(sorted(self.failed.items())),
            "stops": dict(sorted(self.stops.items())),
            "repeated": {name: count for name, count in sorted(self.repeated.items()) if count},
            "unanswered": {name: count for name, count in sorted(self.unanswered.items()) if count},
            "clocks_ahead": dict(sorted(self.clocks_ahead.items())),
            "unsent": dict(sorted(self.unsent.items())),
            "undelivered": by_end(self.undelivered),
            "damaged": by_end(self.damaged),
            "unforwarded": dict(sorted(self.unforwarded.items())),
            "withheld": by_end(self.withheld),
            "budget_bytes": dict(sorted(self.budget_bytes.items())),
            "link_events": by_end(self.link_events),
            "links_received": self.links_received,
            "links_sent": dict(sorted(self.links_sent.items())),
            "other_schemas": {end: list(rows) for end, rows in sorted(self.other_schemas.items())},
            "extra_published": dict(sorted(self.extra_published.items())),
            "extra_unpublished": dict(sorted(self.extra_unpublished.items())),
            "qos_mismatches": {topic: len(texts) for topic, texts in sorted(self.qos_mismatches.items())},
            "kernel_drops": self.kernel_drops,
            "standing": {subject: text for subject, text in sorted(self.standing.items()) if text},
            "by_payload": {
                "published": dict(sorted(self.published.items())),
                "sent": dict(sorted(self.sent.items())),
            },
        }

    def discrepancies(self) -> list[str]:
        """Return a text for each pair of sums that should be equal but are not, as the function `discrepancies` does.

        Sums may disagree while the bridge is handling messages; a difference is an error only when the bridge is idle.
        """
        return discrepancies(self.as_dict())

    def summary(self) -> str:
        """Return the main counters as one line of text."""
        dropped = ", ".join(f"{reason} {count}" for reason, count in sorted(self.dropped.items()) if count) or "none"
        return (
            f"received {self.received}, published {self.published.total()}, sent {self.sent.total()}, "
            f"forwarded {self.forwarded.total()}; dropped: {dropped}; by the kernel: {self.kernel_drops}"
        )


def _count(counter: Counter[str], times: dict[str, float], name: str, count: int) -> None:
    if count:
        counter[name] += count
        times[name] = time.monotonic()


# Module function, not only a method: `simulate` checks the counters that another process printed as JSON.
def discrepancies(account: Mapping[str, Any]) -> list[str]:
    """Return a text for each pair of sums of counters that should be equal but are not; an empty list if all agree.

    A text is ``10 datagrams received, but 9 published and dropped``. ``account`` is a result of `Account.as_dict`.
    Every datagram received must have been published, dropped for a reason, or a link message. Every message of a topic
    must have been sent, refused, superseded, unchanged, late, or failed in the network.
    """
    dropped = sum(account["dropped"].values())
    links = account["links_received"]
    ends = [sum(account[name].values()) for name in ("refused", "superseded", "unchanged", "late", "failed")]
    sums = [
        (
            counted(account["received"], "datagram") + " received",
            account["received"],
            "published, dropped and link messages" if links else "published and dropped",
            account["published"] + dropped + links,
        ),
        (
            counted(account["taken"], "message") + " taken",
            account["taken"],
            "sent, refused, superseded, unchanged, late and failed",
            account["sent"] + sum(ends),
        ),
    ]
    return [f"{what}, but {other} {ends}" for what, count, ends, other in sums if count != other]


def by_end(counts: Mapping[Any, int]) -> dict[str, int]:
    """Return counts by text, sorted, for counts by tuple: peer, board (may be empty) or payload, perhaps a reason."""
    return {" ".join(filter(None, key)): count for key, count in sorted(counts.items()) if count}


class ThrottledWarnings:
    """Log of warnings with a rate limit: for each subject, at most one warning in two seconds is logged.

    A subject is the kind of a warning, such as the reason of a drop. The suppressed warnings are counted, and the next
    warning of the subject tells their number.
    """

    def __init__(self, logger: logging.Logger, clock: Callable[[], float] = time.monotonic) -> None:
        self._logger, self._clock = logger, clock
        self._next: dict[str, float] = {}
        self._last: dict[str, str] = {}
        self._suppressed: Counter[str] = Counter()
        self._lock = threading.Lock()

    def warn(self, subject: str, message: str, level: int = logging.WARNING) -> None:
        """Log a warning; if one of the same subject was logged less than two seconds ago, only count the new one.

        A message that is good news can have a lower ``level``.
        """
        now = self._clock()
        # Warnings come from several threads. Logging happens after the lock is released, since a log handler may block.
        with self._lock:
            if now < self._next.get(subject, now):
                self._suppressed[subject] += 1
                return
            self._next[subject] = now + WARNING_INTERVAL_S
            self._last[subject] = message
            kept_back = self._suppressed.pop(subject, 0)
        self._log(subject, message, kept_back, level)

    def log_suppressed(self) -> None:
        """Log, for each subject, how many warnings were suppressed after the last one.

        Call it at the end of the run.
        """
        with self._lock:
            rest, self._suppressed = self._suppressed, Counter()
        for subject, kept_back in rest.items():
            self._log(subject, self._last[subject], kept_back)

    def _log(self, subject: str, message: str, kept_back: int, level: int = logging.WARNING) -> None:
        more = f" (and {kept_back} more like it)" if kept_back else ""
        facts = {"subject": subject, "kept_back": kept_back}
        self._logger.log(level, "%s%s", message, more, extra={"facts": facts})
