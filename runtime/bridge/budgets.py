"""Budgets of peers (table key ``budget``): what the bridge sends to such a peer leaves through an `Outbox`.

The thread that sends a datagram also sends what waits, if the budget allows it; the timekeeper sends the rest later. So
a datagram is signed when it leaves, because the timestamps of a key must rise in the order of sending.
"""

from __future__ import annotations

import math
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import NamedTuple

from roverlink.runtime.bridge import forwarding, to_peer
from roverlink.runtime.bridge.account import Account
from roverlink.runtime.core.envelope import restore
from roverlink.runtime.core.registry import EndName, Peer, Registry
from roverlink.runtime.core.signing import size_of_signature
from roverlink.runtime.net.destination import Destination
from roverlink.runtime.net.outbox import Outbox, Undelivered, number_of, priority_by_number

_HEADERS = {2: 28, 4: 48}
"""Bytes of the IP and UDP headers, by the length of a socket's address: IPv4 and IPv6."""
_DRAIN_S, _ROUND_S = 1.0, 0.002


class _Letter(NamedTuple):
    number: int
    """Number of the payload; 0 if the datagram has none."""
    end: EndName
    datagram: bytes
    size: int
    send: to_peer.Send


class BudgetedPeer:
    """Outbox of one peer with a budget, a `TimedTask`. Safe to use from several threads."""

    def __init__(self, peer: Peer, registry: Registry, account: Account) -> None:
        """Count what does not leave in ``account``."""
        self._peer, self._account, self._signature = peer, account, registry.signature
        self._rows = {number: handler.route.name for number, handler in registry.by_number.items()}
        priority_of = priority_by_number(registry)
        self._outbox: Outbox[_Letter] = Outbox(lambda letter: priority_of(letter.number), peer.budget, self._discard)
        self.undelivered: Counter[tuple[str, str, str]] = Counter()
        """Datagrams that did not leave, by peer, board and reason."""
        self._given: deque[_Letter] = deque()
        self._lock = threading.Lock()
        self._due = self._planned = math.inf
        self.wake: Callable[[], None] = lambda: None
        """Function that wakes the timekeeper."""

    def put(self, send: to_peer.Send, destination: Destination, datagrams: Sequence[bytes]) -> int:
        """Send datagrams with ``send`` as soon as the budget allows it; return their number.

        Without an address, none waits, and the result is what ``send`` returns.
        """
        if not destination.addresses:
            return send(datagrams)
        for datagram in datagrams:
            number = number_of(datagram, self._signature)
            self._given.append(_Letter(number, destination.end, datagram, self._size(datagram, destination), send))
        self._send_due()
        if self._due < self._planned:
            self._planned = self._due
            self.wake()
        return len(datagrams)

    def run_due(self, _: float) -> None:
        """Send what the budget allows now."""
        self._send_due()

    @property
    def next_due(self) -> float:
        """Time at which the budget allows to send the next datagram; infinity if none waits. For the timekeeper."""
        self._planned = math.inf  # what is put from now on wakes the timekeeper
        self._planned = due = self._due
        return due

    def end(self) -> None:
        """Send what waits until it is too old, for half a second at most. Call it when nothing is put any more."""
        deadline = time.monotonic() + _DRAIN_S  # a thread that hangs may hold the lock
        while self._due < math.inf and time.monotonic() < deadline:
            time.sleep(_ROUND_S)
            self._send_due()

    def _size(self, datagram: bytes, destination: Destination) -> int:
        # Zeros at the end that were stripped come back with a signature, which is of the whole envelope.
        signed = size_of_signature(self._signature) if self._peer.must_sign and self._signature else 0
        size = len(restore(datagram)) + signed if signed else len(datagram)
        return sum(size + _HEADERS[len(address)] for address in destination.addresses)

    def _send_due(self) -> None:
        # Nobody waits for the lock: who has it sends what others give meanwhile, and looks again afterwards.
        while self._given or self._due <= time.monotonic():
            if not self._lock.acquire(blocking=False):
                return
            try:
                while (due := self._next(time.monotonic())) is not None:
                    due.send([due.datagram])
                    self._outbox.has_left(due.size, time.monotonic())
                self._due = self._outbox.next_due
                self._account.budget_bytes[self._peer.name] = self._outbox.sent_bytes
            finally:
                self._lock.release()

    def _next(self, now: float) -> _Letter | None:
        # What was given meanwhile comes first into the outbox, which decides what goes next.
        while self._given:
            letter = self._given.popleft()
            self._outbox.put(letter, now, letter.size)
        return self._outbox.take(now)

    def _discard(self, letter: _Letter, why: Undelivered) -> None:
        self.undelivered[letter.end.peer, letter.end.board, why.value] += 1
        if row := self._rows.get(letter.number):
            self._account.undelivered_of_row[row, why.value] += 1


class Budgets:
    """Outboxes of the peers that have a budget."""

    def __init__(self, registry: Registry, destinations: Mapping[EndName, Destination], account: Account) -> None:
        """Let only Python send to the ``destinations`` of these peers."""
        self.peers = {peer.name: BudgetedPeer(peer, registry, account) for peer in registry.peers if peer.budget}
        for end, destination in destinations.items():
            if end.peer in self.peers:
                destination.keep_from_core()

    def undelivered(self) -> Counter[tuple[str, str, str]]:
        """Return how many datagrams did not leave because of the budgets, by peer, board and reason."""
        counts: Counter[tuple[str, str, str]] = Counter()
        for peer in self.peers.values():
            counts.update(dict(peer.undelivered))
        return counts

    def sending(self, send: to_peer.Send, destination: Destination) -> to_peer.Send:
        """Return a function that sends datagrams with ``send``, through the outbox if the peer has one."""
        peer = self.peers.get(destination.end.peer)
        return send if peer is None else partial(peer.put, send, destination)

    def forwarding(self, send: forwarding.Send) -> forwarding.Send:
        """Return a function that forwards datagrams with ``send``, through the outbox of each peer that has one."""
        if not self.peers:
            return send

        def forward(datagrams: Sequence[bytes], destination: Destination) -> int:
            return self.sending(lambda those: send(those, destination), destination)(datagrams)

        return forward
