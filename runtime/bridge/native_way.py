"""Way of datagrams through the native core of a bridge: which rows take it, and what it counts.

The Python way stays the definition. A row takes the native way if nothing in Python has to see its datagrams: no
signature, no limit of the rate, no observer, no address to check or to learn.
"""

from __future__ import annotations

import ctypes
import dataclasses
import math
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from functools import partial
from typing import NamedTuple, Protocol, runtime_checkable

from roverlink.runtime.bridge.account import Account
from roverlink.runtime.bridge.handling_times import BOUNDS_S, Latencies
from roverlink.runtime.bridge.to_peer import OutboundRow
from roverlink.runtime.core.handler import Route
from roverlink.runtime.core.registry import AnyHandler, AnyStandardHandler, EndName, Registry
from roverlink.runtime.core.tap import Tap
from roverlink.runtime.middleware import Publisher, Subscription
from roverlink.runtime.native import bridge_layout as native
from roverlink.runtime.native.core import NativeCore
from roverlink.runtime.native.datagram_loop import ANY_LENGTH, DatagramLoop, InboundTopics
from roverlink.runtime.native.lending import LentTopic, NativeSubscription
from roverlink.runtime.net.destination import Destination, can_segment


@runtime_checkable
class DatagramObserver(Protocol):
    """Observer that only wants a copy of each datagram, so that the native core can serve it."""

    received: Tap
    """Function that gets the received datagrams."""
    sent: Mapping[str, Tap]
    """Function that gets the datagrams to a peer that are made from messages, by the peer's name."""


class _Forward(NamedTuple):
    """To where a row's datagrams are forwarded."""

    destinations: int
    """Bit by destination."""
    longest: int
    """Length in bytes of the longest datagram that all of them take."""
    is_signed: bool
    """True if the bridge has to sign for one of them."""


class NativeWay:
    """Native way of the inbound rows of a bridge."""

    def __init__(
        self,
        registry: Registry,
        core: NativeCore,
        publisher_of: Callable[[str], Publisher],
        extra_topics: Mapping[AnyStandardHandler, Publisher],
        outbound: Iterable[tuple[AnyHandler | AnyStandardHandler, OutboundRow, Subscription]],
        destinations: Mapping[EndName, Destination],
        must_sign: Collection[str],
        observers: Sequence[DatagramObserver],
    ) -> None:
        """Prepare the way, which no row takes yet.

        ``publisher_of`` returns the publisher of a row by the row's name. ``outbound`` are the topics whose messages go
        to peers. ``must_sign`` are the peers that must sign. ``observers`` get a copy of each datagram.
        """
        self._ends = [*destinations]
        self._refused: frozenset[str] = frozenset()
        self._unforwarded: frozenset[str] = frozenset()
        self._to_all = False
        limits = {peer.name: peer.max_size for peer in registry.peers if peer.max_size is not None}
        self._forwards = {
            handler.route.name: _Forward(
                sum(1 << index for index, end in enumerate(self._ends) if end.peer in handler.route.forward),
                min((limits[peer] for peer in handler.route.forward if peer in limits), default=ANY_LENGTH),
                bool({*handler.route.forward} & {*must_sign}),
            )
            for handler in registry.handlers
            if handler.route.inbound
        }
        self.reasons: dict[str, str] = {
            handler.route.name: f"datagrams of {handler.route.peer} are signed"
            for handler in registry.handlers
            if handler.route.peer in must_sign
        }
        """Reason why Python handles the messages of a row, by the row's name."""
        rows = [
            InboundTopics(handler, [(handler, publisher_of(handler.route.name)), *_of_row(handler, extra_topics)])
            for handler in registry.handlers
            if handler.route.inbound and handler.route.peer not in must_sign
        ]
        links = [] if registry.link is None else [registry.link.number]
        received = [one.received for one in observers]
        self.loop = DatagramLoop(core, rows, [*destinations.values()], links, BOUNDS_S, received)
        self.reasons |= self.loop.reasons
        self._outbound: list[tuple[Route, EndName, native.Subscription]] = []
        for handler, row, subscription in outbound:
            end = registry.end_of(handler.route)
            if handler.route.name in self.reasons:
                continue
            if reason := self._why_not(handler, subscription, core, registry):
                self.reasons[handler.route.name] = reason
                continue
            assert isinstance(subscription, NativeSubscription)  # noqa: S101  # or there is a reason
            struct = native.Subscription(
                translation=core.index_of(handler),
                number=handler.route.number,
                socket=ctypes.pointer(destinations[end].connected_socket),
                segments=can_segment(),
            )
            taps = [one.sent[end.peer] for one in observers]
            try:
                subscription.lend_to(core, LentTopic(struct, row.send_again, (), taps))
            except AttributeError as error:  # the middleware's library may be another version
                self.reasons[handler.route.name] = str(error)
                continue
            self._outbound.append((handler.route, end, struct))
            row.follow(partial(_sent_at, struct))

    @staticmethod
    def _why_not(
        handler: AnyHandler | AnyStandardHandler,
        subscription: Subscription,
        core: NativeCore,
        registry: Registry,
    ) -> str:
        """Return the reason why Python handles the messages of an outbound row; empty if the core can."""
        route = handler.route
        if reason := core.reason(handler):
            return reason
        if route.max_rate is not None:
            return "max_rate"
        if registry.peers_by_name[route.peer].strip_trailing_zeros:
            return "strip_trailing_zeros"
        return "" if isinstance(subscription, NativeSubscription) else "the middleware takes them in Python"

    def refuse(self, rows: frozenset[str], forwards: Mapping[EndName, frozenset[str]]) -> None:
        """Let no row take the native way that is refused, or no longer forwarded to some ends."""
        self._refused, self._unforwarded = rows, frozenset().union(*forwards.values())
        self._decide()

    def follow(self, forward_policy: str) -> None:
        """Use a policy from now on: ``mapping`` forwards to the peers that a row names, ``all`` to every peer."""
        self._to_all = forward_policy == "all"
        self._decide()

    def _decide(self) -> None:
        kept = self._refused if self._to_all else self._refused | self._unforwarded
        for name, row in self.loop.rows.items():
            forward = self._forwards[name]
            row.forward = (1 << len(self._ends)) - 1 if self._to_all else forward.destinations
            row.longest = ANY_LENGTH if self._to_all else forward.longest
            row.native = name not in kept and (self._to_all or not forward.is_signed)
        for route, _, subscription in self._outbound:
            subscription.native = route.name not in self._refused

    def summary(self) -> str:
        """Return a text about the rows that the core handles, and why it does not handle the others."""
        signed = (
            {}
            if self._to_all
            else {name: "it is forwarded with a signature" for name in self.loop.rows if self._forwards[name].is_signed}
        )
        by_python = signed | self.reasons
        rows = len({*self.loop.rows, *(route.name for route, _, _ in self._outbound), *self.reasons})
        if not by_python:
            return f"the native core handles all {rows} messages"
        by_reason: dict[str, list[str]] = {}
        for name, reason in by_python.items():
            by_reason.setdefault(reason, []).append(name)
        told = "; ".join(f"{reason}: {', '.join(names)}" for reason, names in by_reason.items())
        if len(by_python) == rows:
            return f"Python handles all messages ({told})"
        return f"the native core handles {rows - len(by_python)} of {rows} messages, and Python the others ({told})"

    @property
    def is_used(self) -> bool:
        """True if messages of a row can take the native way."""
        return bool(self.loop.rows or self._outbound)

    def end(self) -> None:
        """Let no row take the native way any more. Call it before the stops are sent, which nothing may follow."""
        for _, _, subscription in self._outbound:
            subscription.native = False

    def added_to(self, account: Account) -> Account:
        """Return a copy of an account with the counts of the native core."""
        counts = self.loop.counts()
        forwarded = Counter(account.forwarded)
        for end, count in zip(self._ends, counts.forwarded):
            forwarded[end.peer] += count
        taken, sent = Counter(account.taken), Counter(account.sent)
        for route, _, subscription in self._outbound:
            taken[route.name] += subscription.taken
            sent[route.name] += subscription.sent
        return dataclasses.replace(
            account,
            taken=+taken,
            sent=+sent,
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
        for _, end, subscription in self._outbound:
            sent[end] += subscription.sent
        return sent


def _sent_at(struct: native.Subscription) -> float:
    return struct.sent_at / 1e9 if struct.sent_at else -math.inf


def _of_row(
    handler: AnyHandler, extra_topics: Mapping[AnyStandardHandler, Publisher]
) -> list[tuple[AnyStandardHandler, Publisher]]:
    return [(one, publisher) for one, publisher in extra_topics.items() if one.route.name == handler.route.name]
