"""Exchange of link messages with all ends of the link: compare the schemas of the rows, and measure the link.

A link message does not name its sender. The principal of the datagram and the rows that the message lists tell it (see
`Principal`), so a link message changes only what is known about an end for which its principal may speak.

A sender chooses a new session when it starts. Two senders of one end, such as two laptops, have two sessions. A session
belongs to its principal: the same number from somebody else is another session. It ends when its sender is silent for
three seconds while another sender of the same end speaks; it has been started again.

A new session is answered at once with the hashes of all rows, but not twice in a second: anybody who may send link
messages can also invent sessions.

The receiving thread takes link messages, the timekeeper's thread sends them, and the monitor's thread reads the result.
"""

from __future__ import annotations

import math
import threading
import time
from collections import Counter, defaultdict, deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from roverlink.runtime.bridge.account import Account, ThrottledWarnings
from roverlink.runtime.bridge.native_way import NativeWay
from roverlink.runtime.core import link_message
from roverlink.runtime.core.envelope import strip_trailing_zeros
from roverlink.runtime.core.errors import NOT_PROVEN
from roverlink.runtime.core.link_message import LinkMessage, LinkWriter
from roverlink.runtime.core.link_statistics import Exchange, LinkStatistics
from roverlink.runtime.core.principals import EndRows, Principal
from roverlink.runtime.core.registry import EndName, Registry
from roverlink.runtime.core.translator import Translation

_SILENT_S = 3.0
_MOST_SENDERS = 8
"""Largest number of sessions of an end that are remembered; a stranger could send any number."""
_MOST_UNKNOWN = 64
"""Largest number of sessions of unknown senders that are remembered, so that each is logged once."""

SAME, DIFFERS, UNKNOWN = "same", "differs", "unknown"
"""Results of the comparison of schemas. `UNKNOWN` means that the end has never told the hash of a row."""


@dataclass(eq=False)
class _Sender:
    """Program at the other end, from its start to its end."""

    end: EndName
    """End that the program is."""
    heard: float = 0.0
    """Time of the last link message in seconds."""
    hashes: dict[int, int] = field(default_factory=dict)
    statistics: LinkStatistics = field(default_factory=LinkStatistics)
    warned: set[int] = field(default_factory=set)
    """Numbers of rows about which a warning was logged."""


@dataclass(frozen=True)
class EndReport:
    """Result of the link messages of one end; numbers are those of the sender that was heard last."""

    end: EndName
    schema: str
    """`SAME`, `DIFFERS` or `UNKNOWN`."""
    differing: tuple[str, ...]
    """Names of the rows whose schema differs at any sender of the end."""
    untold: tuple[str, ...]
    """Names of the end's own rows whose hash no sender has told."""
    told: Mapping[str, int] = field(default_factory=dict)
    """Hashes that the sender heard last has told, by the name of the row."""
    senders: int = 0
    restarts: int = 0
    age: float | None = None
    """Seconds since the last link message; None if there was none."""
    statistics: LinkStatistics | None = None
    """None if the end has never sent a link message."""
    lost_in: int | None = None
    """Datagrams of the end that were lost; None if several senders speak, whose datagrams cannot be told apart."""
    loss_in: float | None = None
    """Share of the datagrams lost in the last seconds, from 0 to 1; None if unknown."""
    lost_out: int | None = None
    """Datagrams to the end that were lost; None if it is unknown."""
    loss_out: float | None = None
    clock_offset_us: int | None = None
    """Clock of the end minus the system's clock of this computer, in microseconds; None if it is unknown."""

    def measured(self) -> dict[str, float]:
        """Return the measurements that are known, by name. Times are in seconds, and shares from 0 to 1."""
        values: dict[str, float | None] = {
            "age": self.age,
            "lost_in": self.lost_in,
            "loss_in": self.loss_in,
            "lost_out": self.lost_out,
            "loss_out": self.loss_out,
        }
        if statistics := self.statistics:
            values |= {
                "messages": statistics.messages,
                "reordered": statistics.reordered,
                "duplicates": statistics.duplicates,
                "jitter": _seconds(statistics.jitter_us),
                "round_trip": _seconds(statistics.round_trip_us),
                "clock_offset": _seconds(self.clock_offset_us),
            }
        return {name: value for name, value in values.items() if value is not None}


class LinkExchange:
    """Exchange of link messages with all ends; a `TimedTask`, whose `run_due` sends the link messages that are due."""

    def __init__(
        self,
        registry: Registry,
        hashes: Mapping[int, int],
        sends: Mapping[EndName, Callable[[Sequence[bytes]], int]],
        refuse: Callable[[frozenset[str], Mapping[EndName, frozenset[str]]], None],
        policy: str,
        account: Account,
        warnings: ThrottledWarnings,
    ) -> None:
        """Exchange link messages with the ends in ``sends``, each with the function that sends datagrams to it.

        ``hashes`` is the hash of each row's schema, by the number of the payload.
        ``refuse`` is called when other rows than before are to be refused, with the names of the rows to refuse, and
        of the rows not to forward to each end. ``policy`` is ``warn`` or ``refuse``. Link messages are counted in
        ``account``.
        """
        self._hashes, self._registry = hashes, registry
        self._warnings = warnings
        self._sends, self._refuse, self._policy = sends, refuse, policy
        self._rows = EndRows(registry)
        self._own = self._rows.own
        session = link_message.new_session()
        self._writers = {
            end: LinkWriter(registry.envelope, session, {number: hashes[number] for number in self._rows.in_turn[end]})
            for end in sends
        }
        self._due = dict.fromkeys(sends, time.monotonic())
        self._asked: set[EndName] = set(sends)  # ends that need the hashes of all rows at once
        self._told = dict.fromkeys(sends, -math.inf)  # time at which each end got them
        self._began_us = time.time_ns() // 1000 - int(time.monotonic() * 1e6)
        self._senders: dict[tuple[Principal, int], _Sender] = {}  # by principal and session
        self._unknown: deque[int] = deque(maxlen=_MOST_UNKNOWN)  # sessions whose sender is unknown
        self._restarts: Counter[EndName] = Counter()
        self._received: Counter[str | None] = Counter()  # by row
        self._received_links: Counter[EndName] = Counter()
        self._refused: tuple[frozenset[str], dict[EndName, frozenset[str]]] = frozenset(), {}
        self._account = account
        self._lock = threading.Lock()
        self.wake: Callable[[], None] = lambda: None
        self.on_start: Callable[[EndName], None] = lambda _: None
        """Function that is called when another program than before speaks at an end, but at most once a second."""
        self.native: NativeWay | None = None
        """Native way of the bridge, which counts datagrams itself."""
        self._native_sent: Counter[EndName] = Counter()

    # --- sending ---

    def count_sent(self, end: EndName, datagrams: int) -> None:
        """Count datagrams to an end that are not link messages."""
        self._writers[end].count_sent(datagrams)

    def _count_natively_sent(self) -> None:
        """Count the datagrams that the native core has sent since the last call. The caller holds the lock."""
        if self.native is not None:
            before, self._native_sent = self._native_sent, self.native.sent()
            for end, sent in self._native_sent.items():
                self._writers[end].count_sent(sent - before[end])

    def run_due(self, now: float) -> None:
        """Send the link messages whose time has come."""
        for end, send in self._sends.items():
            if now < self._due[end]:
                continue
            with self._lock:
                self._count_natively_sent()
                turns, has_started = 1, end in self._asked
                if has_started:
                    self._asked.discard(end)
                    turns, self._told[end] = self._writers[end].turns, now
                self._due[end] = now + link_message.PERIOD_S
            strip = self._registry.peers_by_name[end.peer].strip_trailing_zeros
            for _ in range(turns):
                datagram = self._writers[end].write(self._now_us())
                self._account.links_sent[end.peer] += send([strip_trailing_zeros(datagram) if strip else datagram])
            if has_started:
                self.on_start(end)

    @property
    def next_due(self) -> float:
        """Time at which the next link message is due."""
        return min(self._due.values())

    def _now_us(self) -> int:
        # Of the monotonic clock, so that nobody can set it; it starts at the system's time, which peers may want.
        return self._began_us + int(time.monotonic() * 1e6)

    # --- receiving ---

    def take(self, translation: Translation) -> list[EndName]:
        """Count the datagrams of a batch, take the link messages in it, and return the ends that have sent these."""
        names, links = translation.names, iter(translation.links)
        counted = 0
        speakers: list[EndName | None] = []
        for index, name in enumerate(names):
            if name == link_message.NAME:
                self._received.update(names[counted:index])
                counted = index + 1
                principal, link = next(links)
                speakers.append(self._take(principal, link_message.read(link)))
                self._account.links_received += 1
        self._received.update(names[counted:])
        # They have no name in `names`, but they have arrived.
        self._received.update(e.row for e in translation.refusals if e.row and e.reason not in NOT_PROVEN)
        return [*filter(None, speakers)]

    def follow(self, policy: str) -> None:
        """Use a policy from now on: ``warn`` or ``refuse``. Safe to call from any thread."""
        with self._lock:
            self._policy = policy
            self._apply()

    def _take(self, principal: Principal, message: LinkMessage) -> EndName | None:
        """Take a link message of a principal. Return the end that has sent it, or None if that is unknown."""
        now, arrived_us = time.monotonic(), self._now_us()
        with self._lock:
            self._count_natively_sent()
            sender = self._senders.get((principal, message.session))
            told = {number: hash for number, hash in message.hashes.items() if number in self._hashes}
            hashes = {**(sender.hashes if sender else {}), **told}
            end = self._rows.end_of({self._registry.by_number[number].route.name for number in hashes}, principal)
            if end is None:
                if message.session not in self._unknown:
                    self._unknown.append(message.session)
                    text = "a link message has no row of the table: its sender is unknown"
                    self._warnings.warn("unknown sender", text)
                return None
            destination = self._destination(end)
            is_new = sender is None
            if sender is None:
                sender = self._senders[principal, message.session] = _Sender(end)
                self._asked.add(destination)
                self._due[destination] = min(self._due[destination], self._told[destination] + link_message.PERIOD_S)
            sender.heard, sender.hashes = now, hashes
            if end != sender.end:  # the first rows of a sender may fit another end, whose datagrams are others
                sender.end, sender.statistics = end, LinkStatistics()
            writer = self._writers[destination]
            duplicate = sender.statistics.is_duplicate(message)
            received = self._received_from(end)
            sender.statistics.take(message, arrived_us, received, writer.sent_before(message.echo_us))
            if not duplicate:
                writer.note_heard(message, arrived_us, received)
                self._received_links[end] += 1
            self._retire(end, now)
            self._warn(sender)
            self._apply()
        if is_new:
            self.wake()
        return end

    def _destination(self, end: EndName) -> EndName:
        """Return the end to which the bridge sends what concerns an end: boards may share the address of their peer."""
        if end in self._writers:
            return end
        return next(writer for writer in self._writers if writer.peer == end.peer)

    def _received_from(self, end: EndName) -> int:
        native = self.native.handled(self._own[end]) if self.native is not None else 0
        return sum(self._received[row] for row in self._own[end]) + self._received_links[end] + native

    def _retire(self, end: EndName, now: float) -> None:
        """Forget the silent senders of an end at which another sender speaks, and those that are too many."""
        senders = self._of_end(end)
        silent = [sender for sender in senders if sender.heard < now - _SILENT_S]
        self._restarts[end] += len(silent)
        gone = [*silent, *senders[_MOST_SENDERS:]]
        self._senders = {key: sender for key, sender in self._senders.items() if sender not in gone}

    def _of_end(self, end: EndName) -> list[_Sender]:
        """Return the senders of an end, the one that was heard last first."""
        senders = [sender for sender in self._senders.values() if sender.end == end]
        return sorted(senders, key=lambda sender: -sender.heard)

    # --- schemas ---

    def _differing(self, sender: _Sender) -> set[int]:
        return {number for number, hash in sender.hashes.items() if hash != self._hashes[number]}

    def _all_differing(self) -> dict[str, list[str]]:
        numbers: defaultdict[str, set[int]] = defaultdict(set)
        for sender in self._senders.values():
            if differing := self._differing(sender):
                numbers[str(sender.end)] |= differing
        return {end: [self._registry.by_number[n].route.name for n in sorted(found)] for end, found in numbers.items()}

    def _warn(self, sender: _Sender) -> None:
        """Log a warning about the rows that differ, once for each row and start of the sender."""
        new = sorted(self._differing(sender) - sender.warned)
        if not new:
            return
        sender.warned |= {*new}
        rows = ", ".join(f"{self._registry.by_number[number].route.name} ({number})" for number in new)
        done = "refused" if self._policy == "refuse" else "passed on; values may be misread (parameter link_policy)"
        text = f"{sender.end} has another schema of {rows}: messages are {done}"
        self._warnings.warn(f"schema {sender.end} {rows}", text)

    def _apply(self) -> None:
        """Refuse the rows that differ, if the policy says so."""
        self._account.other_schemas = self._all_differing()
        rows: set[str] = set()
        forwards: dict[EndName, frozenset[str]] = {}
        for sender in self._senders.values() if self._policy == "refuse" else ():
            names = {self._registry.by_number[number].route.name for number in self._differing(sender)}
            rows |= names & self._own[sender.end]
            end = self._destination(sender.end)
            forwards[end] = forwards.get(end, frozenset()) | (names - self._own[sender.end])
        refused = frozenset(rows), {end: names for end, names in forwards.items() if names}
        if refused != self._refused:
            self._refused = refused
            self._refuse(*refused)

    # --- the result ---

    def reports(self) -> list[EndReport]:
        """Return the result for each end.

        A peer with boards is listed in their place if one program speaks for the whole peer.
        """
        with self._lock:
            now, wall_us = time.monotonic(), time.time_ns() // 1000
            reports = []
            whole = {sender.end for sender in self._senders.values() if not sender.end.board}
            for end in self._own:
                if end in whole or (EndName(end.peer) not in whole and (end.board or not self._has_boards(end.peer))):
                    reports.append(self._report(end, now, self._now_us() - wall_us))
            return sorted(reports, key=lambda report: report.end)

    def exchanges(self, end: EndName) -> Sequence[Exchange]:
        """Return the last exchanges with the sender of an end that was heard last."""
        with self._lock:
            senders = self._of_end(end)
            return tuple(senders[0].statistics.exchanges) if senders else ()

    def _has_boards(self, peer: str) -> bool:
        return any(end.peer == peer and end.board for end in self._own)

    def _report(self, end: EndName, now: float, ahead_us: int) -> EndReport:
        """Return the result for an end; ``ahead_us`` is the own clock of link messages minus the system's clock."""
        senders = self._of_end(end)
        rows = {self._registry.by_name[name].route.number: name for name in sorted(self._rows.spoken[end])}
        said = {number for sender in senders for number in sender.hashes}
        differing = {number for sender in senders for number in self._differing(sender)}
        untold = [name for number, name in rows.items() if number not in said and name in self._own[end]]
        schema = DIFFERS if differing else SAME if said else UNKNOWN
        report = EndReport(end, schema, tuple(rows[number] for number in sorted(differing)), tuple(untold))
        if not senders:
            return report
        statistics = senders[0].statistics
        alone = len(senders) == 1
        offset = statistics.clock_offset_us
        return replace(
            report,
            told={rows[number]: hash for number, hash in senders[0].hashes.items() if number in rows},
            senders=len(senders),
            restarts=self._restarts[end],
            age=now - senders[0].heard,
            statistics=statistics,
            lost_in=statistics.inbound.lost if alone else None,
            loss_in=statistics.inbound.recent if alone else None,
            lost_out=statistics.outbound.lost if statistics.outbound.recent is not None else None,
            loss_out=statistics.outbound.recent,
            clock_offset_us=None if offset is None else offset + ahead_us,
        )


def _seconds(microseconds: float | None) -> float | None:
    return None if microseconds is None else microseconds / 1e6
