"""The account of a bridge: what came, what went where, and what was dropped for which reason."""

from __future__ import annotations

import logging
import threading
import time
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

WARNING_INTERVAL_S = 2.0


@dataclass
class Account:
    """Counts since the start. Each counter is written by one thread; readers see it a moment late."""

    received: int = 0
    """Datagrams that were taken from the socket."""
    published: Counter[str] = field(default_factory=Counter)
    """Messages to topics, by the name of the payload."""
    fed: Counter[str] = field(default_factory=Counter)
    """Messages to the further topics of rows, by topic."""
    unfed: Counter[str] = field(default_factory=Counter)
    """Messages that a further topic did not get, by topic: a value did not fit, or its subscribers were too slow."""
    sent: Counter[str] = field(default_factory=Counter)
    """Datagrams made from messages of topics, by the name of the payload."""
    forwarded: Counter[str] = field(default_factory=Counter)
    """Raw datagrams handed on, by the name of the peer."""
    dropped: Counter[str] = field(default_factory=Counter)
    """Datagrams that were not bridged, by reason."""
    dropped_of_row: Counter[tuple[str, str]] = field(default_factory=Counter)
    """Of those, the ones whose payload is known: by its name and the reason."""
    unsent: Counter[str] = field(default_factory=Counter)
    """Datagrams that the network refused, by the name of the peer."""
    taken: Counter[str] = field(default_factory=Counter)
    """Messages that topics gave, by the name of the payload."""
    refused: Counter[str] = field(default_factory=Counter)
    """Messages of topics that did not become a datagram, by the name of the payload."""
    superseded: Counter[str] = field(default_factory=Counter)
    """Messages of topics that a newer one took the place of, by the name of the payload."""
    failed: Counter[str] = field(default_factory=Counter)
    """Messages of topics whose datagram the network refused, by the name of the payload."""
    stops: Counter[str] = field(default_factory=Counter)
    """Datagrams that told a peer to stop, by the name of the payload; no message stands behind them."""
    kernel_drops: int = 0
    """Datagrams that the kernel dropped because nobody had read the earlier ones yet."""

    def as_dict(self) -> dict[str, Any]:
        """The account as plain values, for JSON."""
        return {
            "received": self.received,
            "published": self.published.total(),
            "sent": self.sent.total(),
            "forwarded": self.forwarded.total(),
            "dropped": {reason: count for reason, count in sorted(self.dropped.items()) if count},
            "taken": self.taken.total(),
            "refused": dict(sorted(self.refused.items())),
            "superseded": dict(sorted(self.superseded.items())),
            "failed": dict(sorted(self.failed.items())),
            "stops": dict(sorted(self.stops.items())),
            "unsent": dict(sorted(self.unsent.items())),
            "fed": dict(sorted(self.fed.items())),
            "unfed": dict(sorted(self.unfed.items())),
            "kernel_drops": self.kernel_drops,
            "by_payload": {
                "published": dict(sorted(self.published.items())),
                "sent": dict(sorted(self.sent.items())),
            },
        }

    def discrepancies(self) -> list[str]:
        """As the function of this name, of the counts as they stand. Only at rest do they have to agree."""
        return discrepancies(self.as_dict())

    def summary(self) -> str:
        """The account in one line."""
        dropped = ", ".join(f"{reason} {count}" for reason, count in sorted(self.dropped.items()) if count) or "none"
        return (
            f"received {self.received}, published {self.published.total()}, sent {self.sent.total()}, "
            f"forwarded {self.forwarded.total()}; dropped: {dropped}; by the kernel: {self.kernel_drops}"
        )


def discrepancies(account: Mapping[str, Any]) -> list[str]:
    """Where the sums of an account (`Account.as_dict`) do not agree; empty where they do.

    Every datagram that was received is published or dropped for a reason; every message that a topic gave is sent,
    refused, superseded, or failed in the network.
    """
    dropped = sum(account["dropped"].values())
    ends = [sum(account[name].values()) for name in ("refused", "superseded", "failed")]
    sums = [
        ("datagrams received", account["received"], "published and dropped", account["published"] + dropped),
        ("messages taken", account["taken"], "sent, refused, superseded and failed", account["sent"] + sum(ends)),
    ]
    return [f"{one} {what}, but {other} {ends}" for what, one, ends, other in sums if one != other]


class ThrottledWarnings:
    """Warns of each subject at most every two seconds, and says how many warnings it kept back."""

    def __init__(self, logger: logging.Logger, clock: Callable[[], float] = time.monotonic) -> None:
        self._logger, self._clock = logger, clock
        self._next: dict[str, float] = {}
        self._last: dict[str, str] = {}
        self._kept_back: Counter[str] = Counter()
        self._lock = threading.Lock()

    def warn(self, subject: str, message: str) -> None:
        """Log a warning about a subject, or count it where one was logged a moment ago."""
        now = self._clock()
        with self._lock:
            if now < self._next.get(subject, now):
                self._kept_back[subject] += 1
                return
            self._next[subject] = now + WARNING_INTERVAL_S
            self._last[subject] = message
            kept_back = self._kept_back.pop(subject, 0)
        self._log(subject, message, kept_back)

    def tell_rest(self) -> None:
        """Say how many warnings were kept back since the last of each subject: nothing more may come."""
        with self._lock:
            rest, self._kept_back = self._kept_back, Counter()
        for subject, kept_back in rest.items():
            self._log(subject, self._last[subject], kept_back)

    def _log(self, subject: str, message: str, kept_back: int) -> None:
        more = f" (and {kept_back} more like it)" if kept_back else ""
        facts = {"subject": subject, "kept_back": kept_back}
        self._logger.warning("%s%s", message, more, extra={"facts": facts})
