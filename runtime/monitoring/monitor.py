"""Monitor of a bridge: reads the bridge's counters periodically.

From the counters it computes the rate and the level (OK, WARN, ERROR or STALE) of each row.
"""

from __future__ import annotations

import functools
import logging
import math
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple, Protocol

from roverlink.runtime.bridge.account import Account
from roverlink.runtime.bridge.ends import LinkState
from roverlink.runtime.bridge.handling_times import Latencies
from roverlink.runtime.bridge.link_exchange import EndReport
from roverlink.runtime.core.board_clock import ClockReport
from roverlink.runtime.core.errors import Reason
from roverlink.runtime.core.handler import Route
from roverlink.runtime.core.periodic_thread import PeriodicThread
from roverlink.runtime.core.registry import EndName, Registry
from roverlink.runtime.monitoring.liveness import Liveness, link_age, liveness_of
from roverlink.runtime.monitoring.state import Budget, EndState, Level, Recording, RowState, State
from roverlink.runtime.net.udp import SocketState

SAMPLE_S = 1.0
"""Interval in seconds at which the counters are read, and listeners are called."""
WINDOW_S = 2.0
"""Length in seconds of the time window in which rates are averaged, and in which a drop causes a warning."""

_KERNEL = "dropped by the kernel"
_LOW = 0.8  # share of the expected rate below which a row gets a warning
_SILENT_PERIODS = 3.0  # periods of the expected rate after which a row is stale, but at least WINDOW_S


class Watched(Protocol):
    """Parts of a bridge that the monitor reads."""

    @property
    def account(self) -> Account:
        """Counters of the bridge."""

    def latencies(self) -> Latencies:
        """Return the histogram of the times that the bridge needed for its batches of datagrams."""

    def socket_state(self) -> SocketState:
        """Return the fill level of the socket's receive buffer, and how many datagrams the kernel has dropped."""

    def link_states(self) -> Mapping[EndName, LinkState]:
        """Return the addresses of each end of the link, with their state."""

    def link_reports(self) -> list[EndReport]:
        """Return what the link messages of each end tell; empty for a table without the link message."""

    def clock_reports(self) -> Mapping[EndName, ClockReport]:
        """Return what is known of the clock of each board that stamps messages."""


class _Sample(NamedTuple):
    """Values of a bridge's counters at one moment."""

    time: float
    """Seconds of a monotonic clock."""
    crossed: Counter[str]
    """Messages published on topics or sent to peers, by payload."""
    dropped: Counter[tuple[str, str]]
    """Messages that were not bridged, by payload and reason."""
    received: int
    """Datagrams read from the socket."""
    lost: Counter[str]
    """Datagrams and messages lost, by reason."""
    budget_bytes: Counter[str]
    """Bytes sent to each peer with a budget."""


class Monitor:
    """Monitor of one bridge. A context manager; its thread reads counters and calls listeners."""

    def __init__(
        self,
        node: str,
        registry: Registry,
        bridge: Watched,
        recording: Callable[[], Recording | None] = lambda: None,
        clock: Callable[[], float] = time.monotonic,
        logger: logging.Logger | None = None,
    ) -> None:
        self._node, self._registry, self._bridge = node, registry, bridge
        self._recording, self._clock = recording, clock
        self._samples: deque[_Sample] = deque()
        self._lock = threading.Lock()  # of the samples: several threads ask for the state
        self._outbound = {handler.route.name for handler in registry.handlers if not handler.route.inbound}
        self._listeners: list[Callable[[Callable[[], State]], None]] = []
        self._thread = PeriodicThread("monitor", SAMPLE_S, self._observe, logger or logging.getLogger("roverlink"))
        self.sample()

    def add_listener(self, listener: Callable[[Callable[[], State]], None]) -> None:
        """Let the monitor call ``listener`` once a second, on the monitor's thread.

        It gets a function that returns the state, which costs nothing unless it is called. Call this before entering
        the monitor's ``with`` block.
        """
        self._listeners.append(listener)

    def __enter__(self) -> Monitor:
        self._thread.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._thread.__exit__()

    def _observe(self) -> None:
        """Read the counters, and call the listeners: all of them, also if one raises an error."""
        self.sample()
        state, failures = functools.cache(self._state), list[Exception]()
        for listener in self._listeners:
            try:
                listener(state)
            except Exception as failure:  # noqa: BLE001  # it is raised below
                failures.append(failure)
        if failures:
            raise failures[0]

    def sample(self) -> None:
        """Read the counters once and store their values. The monitor's thread calls this periodically."""
        self._account = account = self._bridge.account
        now, crossed = self._clock(), account.published + account.sent
        # A peer that sends a payload of an outbound row does no harm to the row, so the row must not look broken.
        dropped = Counter({key: count for key, count in account.dropped_of_row.items() if key[0] not in self._outbound})
        dropped.update({(name, "refused"): count for name, count in account.refused.items()})
        dropped.update({(name, "late"): count for name, count in account.late.items()})
        dropped.update({(name, "unanswered"): count for name, count in account.unanswered.items() if count})
        dropped.update({key: count for key, count in account.undelivered_of_row.items() if key[0] in self._outbound})
        others: dict[str, Counter[Any]] = {
            "refused": account.refused,
            "late": account.late,
            "not sent": account.unsent,
            "unanswered": account.unanswered,
            "not delivered": account.undelivered,
            "damaged": account.damaged,
        }
        lost = account.dropped + Counter({reason: counter.total() for reason, counter in others.items()})
        del lost[Reason.REPEATED.value]  # it has been handled when it came first
        lost[_KERNEL] = self._bridge.socket_state().drops  # the account reads it only when a datagram arrives
        bytes_sent = Counter(account.budget_bytes)
        with self._lock:
            self._samples.append(_Sample(now, crossed, dropped, account.received, lost, bytes_sent))
            # Keep one sample older than the window, so that rates cover the whole window.
            while len(self._samples) > 2 and self._samples[1].time <= now - WINDOW_S:
                self._samples.popleft()

    def liveness(self) -> dict[EndName, Liveness]:
        """Return the liveness of each end of the link, and of each board that has rows."""
        now, last = self._clock(), self._account.last_crossed
        routes = [handler.route for _, handler in sorted(self._registry.by_number.items())]
        link_ages = {one.end: one.age for one in self._bridge.link_reports() if one.age is not None}
        boards = [EndName(route.peer, route.board) for route in routes if route.board]
        return {
            end: liveness_of(
                [
                    (now - last[route.name] if route.name in last else None, route.expect_rate)
                    for route in routes
                    if route.inbound and route.peer == end.peer and end.board in ("", route.board)
                ],
                link_age(link_ages, end),
            )
            for end in dict.fromkeys([*self._bridge.link_states(), *boards])
        }

    def state(self) -> State:
        """Read the counters and return the state of the bridge."""
        self.sample()
        return self._state()

    def _state(self) -> State:
        account, first, last = self._account, self._samples[0], self._samples[-1]
        socket = self._bridge.socket_state()
        recording = self._recording()
        level, message = self._overall(recording, account)
        rows = tuple(self._row(one.route, account) for _, one in sorted(self._registry.by_number.items()))
        links = self._bridge.link_reports()
        return State(
            node=self._node,
            fingerprint=self._registry.fingerprint,
            rows=rows,
            ends=tuple(self._ends()),
            undelivered=dict(account.undelivered),
            damaged=dict(account.damaged),
            unforwarded=dict(account.unforwarded),
            budgets=self._budgets(),
            withheld=dict(account.withheld),
            link_events=dict(account.link_events),
            received=last.received,
            received_rate=(last.received - first.received) / max(last.time - first.time, SAMPLE_S),
            forwarded=dict(account.forwarded),
            unsent=dict(account.unsent),
            clocks_ahead=dict(account.clocks_ahead),
            dropped=dict(account.dropped),
            qos_mismatches={topic: len(texts) for topic, texts in account.qos_mismatches.items()},
            kernel_drops=socket.drops,
            socket_waiting=socket.waiting,
            socket_size=socket.size,
            level=level,
            message=message,
            latencies=self._bridge.latencies(),
            recording=recording,
            links=tuple(links),
        )

    def _overall(self, recording: Recording | None, account: Account) -> tuple[Level, str]:
        if recording is not None and recording.failure is not None:
            return Level.ERROR, f"the recording stopped: {recording.failure}"
        first, last = self._samples[0], self._samples[-1]
        lost = last.lost - first.lost
        if kernel := lost[_KERNEL]:
            came = kernel + last.received - first.received
            text = (
                f"this computer cannot keep up: {_percent(kernel / came)} of the datagrams lost in the last "
                f"{WINDOW_S:.0f} s; end other programs, or let the boards send less"
            )
            return (Level.ERROR if 2 * kernel > came else Level.WARN), text
        if lost:
            reasons = ", ".join(f"{reason} {count}" for reason, count in sorted(lost.items()))
            return Level.WARN, f"datagrams or messages lost in the last {WINDOW_S:.0f} s: {reasons}"
        if standing := "; ".join(filter(None, account.standing.values())):
            return Level.WARN, standing
        if topics := ", ".join(account.qos_mismatches):
            return Level.WARN, f"the QoS of other nodes does not match on {topics}; change the QoS of one side"
        return Level.OK, "nothing lost"

    def _budgets(self) -> dict[str, Budget]:
        first, last = self._samples[0], self._samples[-1]
        span, used = max(last.time - first.time, SAMPLE_S), last.budget_bytes - first.budget_bytes
        limits = {peer.name: peer.budget for peer in self._registry.peers if peer.budget}
        return {peer: Budget(limit, used[peer] / span, last.budget_bytes[peer]) for peer, limit in limits.items()}

    def _row(self, route: Route, account: Account) -> RowState:
        first, last = self._samples[0], self._samples[-1]
        name, span = route.name, max(last.time - first.time, SAMPLE_S)
        rate = (last.crossed[name] - first.crossed[name]) / span
        seen, stopped = account.last_crossed.get(name), account.last_stops.get(name, -math.inf)
        age = None if seen is None else self._clock() - seen
        dropped = {reason: count for (row, reason), count in sorted(last.dropped.items()) if row == name}
        fresh = {reason: count - first.dropped[name, reason] for reason, count in dropped.items()}
        mismatches = account.qos_mismatches.get(route.topic, ())
        fresh = {reason: count for reason, count in fresh.items() if count}
        level, message = _assess(route.expect_rate, rate, age, fresh, mismatches)
        stopping = stopped > (-math.inf if seen is None else seen)
        if stopping and level in (Level.OK, Level.STALE):  # else there is a reason that matters more
            message = f"{message or 'silent'}; the bridge sends the stop"
        return RowState(
            number=route.number,
            name=name,
            direction=route.direction,
            topic=route.topic,
            peer=route.peer,
            board=route.board,
            count=last.crossed[name],
            rate=rate,
            age=age,
            expect_rate=route.expect_rate,
            dropped=dropped,
            deadman_after=None if route.deadman is None else route.deadman.after_ms / 1000,
            stops=None if route.deadman is None else account.stops[name],
            stopping=stopping,
            qos_mismatches=len(mismatches),
            level=level,
            message=message,
        )

    def _ends(self) -> Iterator[EndState]:
        """Yield the state of each end. A board without an address of its own has that of its peer."""
        links, clocks = self._bridge.link_states(), self._bridge.clock_reports()
        for name, liveness in self.liveness().items():
            # One that is in neither is a board that sends, but to which nothing goes.
            link = links.get(name) or links.get(EndName(name.peer)) or LinkState((), "ok")
            level, message = _assess_end(link, liveness)
            yield EndState(name, link.addresses, link.state, liveness, level, message, link.fault, clocks.get(name))


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share >= 0.01 else "less than 1 %"


ADDRESS_PROBLEMS = {
    "unreachable": (Level.ERROR, "the network refuses datagrams to its address"),
    "not_connected": (Level.ERROR, "there is no connection to it"),
    "not_resolved": (Level.WARN, "its host cannot be resolved"),
    "not_learned": (Level.WARN, "its address is not known before its first valid datagram"),
}
"""Level and text of each state of an address that is not ok."""


def _assess_end(link: LinkState, liveness: Liveness) -> tuple[Level, str]:
    level, message = ADDRESS_PROBLEMS.get(link.state, (Level.OK, ""))
    message = link.fault or message
    if liveness.state == "silent":
        silence = f"silent for {liveness.age:.1f} s"
        return max(level, Level.STALE), f"{silence}; {message}" if message else silence
    return level, message


def _assess(
    expected: float | None, rate: float, age: float | None, fresh: dict[str, int], mismatches: Sequence[str]
) -> tuple[Level, str]:
    """Return the level of a row and, as text, the reason for it.

    ``expected`` and ``rate`` are in messages a second. ``age`` is the time since the last message in seconds, or None.
    ``fresh`` holds the messages dropped recently, by reason. ``mismatches`` says which nodes have no matching QoS.
    """
    if fresh:
        drops = ", ".join(f"{reason} {count}" for reason, count in fresh.items())
        return (Level.WARN if rate else Level.ERROR), f"dropped in the last {WINDOW_S:.0f} s: {drops}"
    if mismatches:
        return Level.WARN, "; ".join(mismatches)
    if expected is None:
        return Level.OK, "" if age is not None else "no message yet"
    silence = max(_SILENT_PERIODS / expected, WINDOW_S)
    if age is None or age > silence:
        since = "no message yet" if age is None else f"silent for {age:.1f} s"
        return Level.STALE, f"{since}; {expected:g}/s expected"
    # Below 1.5 Hz the window of two seconds holds too few messages to judge a rate; only silence counts then.
    if rate < _LOW * expected and expected * WINDOW_S >= _SILENT_PERIODS:
        return Level.WARN, f"{rate:.1f}/s; {expected:g}/s expected"
    return Level.OK, ""
