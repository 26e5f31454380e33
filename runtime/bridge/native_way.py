"""Way of datagrams through the native core of a bridge: which rows take it, and what it counts.

The Python way stays the definition. A row takes the native way if the core can do all that Python would do.
"""

from __future__ import annotations

import ctypes
import dataclasses
import math
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import partial
from typing import Protocol, runtime_checkable

from roverlink.numerals import counted
from roverlink.runtime.bridge.account import Account
from roverlink.runtime.bridge.forwarding import LimitedForward
from roverlink.runtime.bridge.handling_times import BOUNDS_S, Latencies
from roverlink.runtime.bridge.limited_row import LimitedRow
from roverlink.runtime.bridge.signed_peers import SignedPeers
from roverlink.runtime.bridge.to_peer import OutboundRow
from roverlink.runtime.bridge.to_topic import InboundRow
from roverlink.runtime.core.errors import Reason
from roverlink.runtime.core.handler import Route
from roverlink.runtime.core.registry import AnyHandler, AnyStandardHandler, EndName, Peer, Registry
from roverlink.runtime.core.tap import Tap
from roverlink.runtime.middleware import Publisher, Subscription
from roverlink.runtime.native import bridge_layout as native
from roverlink.runtime.native.core import NativeCore
from roverlink.runtime.native.datagram_loop import ANY_LENGTH, DatagramLoop, InboundTopics
from roverlink.runtime.native.lending import LentTopic, NativeSubscription
from roverlink.runtime.native.shared_keys import SharedKeys
from roverlink.runtime.native.shared_lock import SharedLock
from roverlink.runtime.net.destination import Destination, can_segment


@runtime_checkable
class DatagramObserver(Protocol):
    """Observer that only wants a copy of each datagram, so that the native core can serve it."""

    received: Tap
    """Function that gets the received datagrams."""
    sent: Mapping[str, Tap]
    """Function that gets the datagrams to a peer that are made from messages, by the peer's name."""


_COMPARED = "datagrams are compared, or sent again"


class NativeWay:
    """Native way of the inbound rows of a bridge."""

    def __init__(
        self,
        registry: Registry,
        core: NativeCore,
        inbound: Mapping[str, InboundRow],
        extra_topics: Mapping[AnyStandardHandler, Publisher],
        outbound: Iterable[tuple[AnyHandler | AnyStandardHandler, OutboundRow, Subscription]],
        destinations: Mapping[EndName, Destination],
        limited: Sequence[LimitedForward],
        signed: SignedPeers,
        observers: Sequence[DatagramObserver],
        in_python: Mapping[str, str],
    ) -> None:
        """Prepare the way, which no row takes yet.

        ``inbound`` are the rows whose datagrams go to topics, by name. ``outbound`` are the topics whose messages go
        to peers. ``limited`` are the forwards with limits. ``signed`` has the keys of the peers that must sign.
        ``observers`` get a copy of each datagram. ``in_python`` has the reason for each row that needs Python, whatever
        the core can do.
        """
        self._ends = [*destinations]
        self._inbound = inbound.values()
        self._refused: frozenset[str] = frozenset()
        self._unforwarded: frozenset[str] = frozenset()
        self._to_all = False
        self._limited = limited
        compared = {one.row for one in limited if one.changes is not None}
        in_python = {**in_python, **dict.fromkeys(compared, _COMPARED)}
        keys = SharedKeys(core)
        strips = {peer.name: peer.strip_trailing_zeros for peer in registry.peers}
        limits = {peer.name: peer.max_size for peer in registry.peers if peer.max_size is not None}
        rows = [
            InboundTopics(
                handler,
                [(handler, inbound[handler.route.name].publisher), *_of_row(handler, extra_topics)],
                sum(1 << index for index, end in enumerate(self._ends) if end.peer in handler.route.forward),
                {
                    self._ends.index(one.destination.end): _shared_pacer(one, core)
                    for one in limited
                    if one.row == handler.route.name
                },
                min((limits[peer] for peer in handler.route.forward if peer in limits), default=ANY_LENGTH),
                _shared_pacer(inbound[handler.route.name], core),
                [*map(keys.stream, signed.streams(handler.route))] if handler.route.peer in signed.must_sign else None,
            )
            for handler in registry.handlers
            if handler.route.inbound and handler.route.name not in in_python
        ]
        links = [] if registry.link is None else [registry.link.number]
        received = [one.received for one in observers]
        forwarding = [
            (destination, keys.signer(signed.signer(*end), strips[end.peer]))
            for end, destination in destinations.items()
        ]
        # The timestamps of a key rise, and the tokens of a sender go to the first.
        is_ordered = bool(signed.must_sign) or any(peer.source_rate for peer in registry.peers)
        number = registry.signature or 0
        self.loop = DatagramLoop(core, rows, forwarding, number, is_ordered, links, BOUNDS_S, received)
        self.reasons = {**self.loop.reasons, **in_python}
        """Reason why Python handles the messages of a row, by the row's name."""
        self._outbound: list[tuple[OutboundRow, Route, EndName, native.Subscription]] = []
        for handler, row, subscription in outbound:
            route, end = handler.route, registry.end_of(handler.route)
            if route.name in self.reasons:
                continue
            if reason := self._why_not(handler, subscription, core, registry.peers_by_name[route.peer]):
                self.reasons[route.name] = reason
                continue
            signer = keys.signer(signed.signer(route.peer, route.board), strips[route.peer])
            assert isinstance(subscription, NativeSubscription)  # noqa: S101  # or there is a reason
            struct = native.Subscription(
                translation=core.index_of(handler),
                number=route.number,
                socket=ctypes.pointer(destinations[end].connected_socket),
                signer=None if signer is None else ctypes.pointer(signer),
                segments=can_segment(),
                pacer=_shared_pacer(row, core),
                strips_zeros=strips[route.peer],
            )
            taps = [one.sent[end.peer] for one in observers]
            try:
                subscription.lend_to(core, LentTopic(struct, row.send_again, row.wake, (), taps))
            except AttributeError as error:  # the middleware's library may be another version
                self.reasons[route.name] = str(error)
                continue
            self._outbound.append((row, route, end, struct))
            row.follow(partial(_sent_at, struct))

    @staticmethod
    def _why_not(
        handler: AnyHandler | AnyStandardHandler, subscription: Subscription, core: NativeCore, peer: Peer
    ) -> str:
        """Return the reason why Python handles the messages of an outbound row; empty if the core can."""
        if handler.route.send:
            return _COMPARED
        if peer.budget:
            return f"{peer.name} has a budget"
        if reason := core.reason(handler):
            return reason
        return "" if isinstance(subscription, NativeSubscription) else "the middleware takes them in Python"

    def refuse(self, rows: frozenset[str], forwards: Mapping[EndName, frozenset[str]]) -> None:
        """Let no row take the native way that is refused, or no longer forwarded to some ends."""
        self._refused, self._unforwarded = rows, frozenset().union(*forwards.values())
        self._decide()

    def follow(self, forward_policy: str) -> None:
        """Use a policy from now on: ``mapping`` forwards to the peers that a row names, ``all`` to every peer."""
        self._to_all = forward_policy == "all"
        self.loop.follow(forwards_all=self._to_all)
        self._decide()

    def _decide(self) -> None:
        kept = self._refused if self._to_all else self._refused | self._unforwarded
        for name, row in self.loop.rows.items():
            row.native = name not in kept
        for _, route, _, subscription in self._outbound:
            subscription.native = route.name not in self._refused

    def summary(self) -> str:
        """Return a text about the rows that the core handles, and why it does not handle the others."""
        rows = len({*self.loop.rows, *(route.name for _, route, _, _ in self._outbound), *self.reasons})
        if not self.reasons:
            return f"the native core handles all messages ({rows})"
        by_reason: dict[str, list[str]] = {}
        for name, reason in self.reasons.items():
            by_reason.setdefault(reason, []).append(name)
        told = "; ".join(f"{reason}: {', '.join(names)}" for reason, names in by_reason.items())
        if len(self.reasons) == rows:
            return f"Python handles all messages ({told})"
        handled = f"{rows - len(self.reasons)} of {counted(rows, 'message')}"
        return f"the native core handles {handled}, and Python the others ({told})"

    @property
    def is_used(self) -> bool:
        """True if messages of a row can take the native way."""
        return bool(self.loop.rows or self._outbound)

    def end(self) -> None:
        """Let no row take the native way any more. Call it before the stops are sent, which nothing may follow."""
        for _, _, _, subscription in self._outbound:
            subscription.native = False

    def added_to(self, account: Account) -> Account:
        """Return a copy of an account with the counts of the native core."""
        counts = self.loop.counts()
        forwarded = Counter(account.forwarded)
        for end, count in zip(self._ends, counts.forwarded):
            forwarded[end.peer] += count
        taken, sent, superseded = Counter(account.taken), Counter(account.sent), Counter(account.superseded)
        dropped = Counter(account.dropped)
        for inbound in self._inbound:
            if inbound.pacer is not None:
                dropped[Reason.SUPERSEDED.value] += inbound.pacer.superseded
        withheld = Counter(account.withheld)
        for one in self._limited:
            if one.pacer is not None and one.pacer.superseded:
                withheld[one.destination.end.peer, one.row, "superseded"] += one.pacer.superseded
        last = {**account.last_crossed}
        times = {**counts.last_published, **{route.name: _sent_at(one) for _, route, _, one in self._outbound}}
        last.update((name, at) for name, at in times.items() if at > last.get(name, 0.0))
        for row, route, _, subscription in self._outbound:
            taken[route.name] += subscription.taken
            sent[route.name] += subscription.sent
            if row.pacer is not None:
                superseded[route.name] += row.pacer.superseded
        return dataclasses.replace(
            account,
            taken=+taken,
            superseded=+superseded,
            dropped=dropped,
            withheld=withheld,
            sent=+sent,
            last_crossed=last,
            received=account.received + counts.received,
            published=account.published + counts.published,
            extra_published=account.extra_published + counts.extra_published,
            forwarded=+forwarded,
        )

    def latencies(self) -> Latencies:
        """Return the histogram of the datagrams that the native core handled."""
        return Latencies(*self.loop.latencies())

    def handled(self, rows: Collection[str]) -> int:
        """Return how many datagrams of some rows the native core has handled."""
        return sum(self.loop.rows[name].handled for name in rows if name in self.loop.rows)

    def sent(self) -> Counter[EndName]:
        """Return how many datagrams the native core has sent to each end."""
        sent = Counter(dict(zip(self._ends, self.loop.counts().forwarded)))
        for _, _, end, subscription in self._outbound:
            sent[end] += subscription.sent
        return sent


def _sent_at(struct: native.Subscription) -> float:
    return struct.sent_at / 1e9 if struct.sent_at else -math.inf


def _shared_pacer(row: LimitedRow, core: NativeCore) -> int | None:
    if row.pacer is None:
        return None
    row.lock = lock = SharedLock(core.library)
    return row.pacer.lend(lock.address)


def _of_row(
    handler: AnyHandler, extra_topics: Mapping[AnyStandardHandler, Publisher]
) -> list[tuple[AnyStandardHandler, Publisher]]:
    return [(one, publisher) for one, publisher in extra_topics.items() if one.route.name == handler.route.name]
