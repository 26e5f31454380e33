"""Forwarding of received datagrams from peers to other peers (table key ``forward``).

A row's datagrams reach the other peers as the protobuf library writes an envelope. Some boards append zeros to their
datagrams, and others strip zeros from them; strict decoders, such as those of prost and upb, refuse both.
"""

from __future__ import annotations

import threading
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence

from roverlink.runtime.bridge.counters import Counters
from roverlink.runtime.bridge.ends import Ends
from roverlink.runtime.bridge.limited_row import LimitedRow
from roverlink.runtime.core.handler import SendLimits
from roverlink.runtime.core.registry import EndName, Registry
from roverlink.runtime.net.destination import Destination

Send = Callable[[Sequence[bytes], Destination], int]
"""Function that sends datagrams to a destination and returns how many of them the network accepted."""


class Forwarding:
    """Forwarder of received datagrams to other peers: to the peers that the row names, or to all peers.

    A peer with boards gets the datagrams at each of its boards. Only one thread may call `forward`.
    """

    limited: Sequence[LimitedForward]
    """Forwards of rows with limits, each to one end. A timekeeper has to run them."""

    def __init__(
        self,
        registry: Registry,
        ends: Ends,
        policy: str,
        send: Send,
        send_raw: Send,
        counters: Counters,
    ) -> None:
        """Forward to the destinations of ``ends``.

        The ``policy`` is ``mapping`` (to the peers that the row names) or ``all`` (every datagram to every peer). The
        function ``send`` sends datagrams of rows to a destination, signed if the peer wants it so, and returns how many
        the network accepted; ``send_raw`` sends any datagrams as they are. ``counters`` count them.
        """
        self._send, self._send_raw, self._counters = send, send_raw, counters
        self._all = tuple(ends.destinations.values())
        self._limits = {peer.name: peer.max_size for peer in registry.peers if peer.max_size is not None}
        self._rows: defaultdict[Destination, set[str]] = defaultdict(set)
        self.limited = limited = []
        for handler in registry.handlers:
            route = handler.route
            limits = dict(route.forward_limits)
            for peer in route.forward if route.inbound else ():
                for destination in ends.of_peer(peer):
                    self._rows[destination].add(route.name)
                    if peer in limits:
                        limited.append(LimitedForward(route.name, destination, limits[peer], registry.signature, self))
        self._limited = {(one.destination, one.row): one for one in limited}
        self._counting = threading.Lock()
        self._refused: Mapping[EndName, frozenset[str]] = {}
        self.follow(policy)

    def refuse(self, rows: Mapping[EndName, frozenset[str]]) -> None:
        """Forward some rows no longer to some ends, which have another schema of them.

        ``rows`` has the names of all these rows by end. Safe to call from any thread. The policy ``all`` forwards them
        all the same.
        """
        self._refused = rows

    def follow(self, policy: str) -> None:
        """Use a policy from now on: ``mapping`` forwards to the peers that the row names, ``all`` to every peer.

        Safe to call from any thread.
        """
        self._to_all = policy == "all"

    def forward(self, datagrams: Sequence[bytes], names: Sequence[str | None], restored: Mapping[bytes, bytes]) -> None:
        """Forward datagrams; ``names`` holds the payload name of each datagram, or None if the datagram was refused.

        ``restored`` holds the envelope without padding, and with its stripped zeros, for each datagram that was not
        exactly an envelope. With the policy ``all``, datagrams go as they are.
        """
        # One call for each end: `Destination.send_all` sends runs of equal size with one system call.
        if self._to_all:
            for destination in self._all:
                self._hand_on(datagrams, destination, self._send_raw)
            return
        if restored:
            datagrams = [restored.get(datagram, datagram) for datagram in datagrams]
        for destination, rows in self._rows.items():
            peer = destination.end.peer
            if refused := self._refused.get(destination.end):
                self._counters.account.unforwarded[peer] += sum(name in rows & refused for name in names)
                rows = rows - refused
            own = {index: datagram for index, datagram in enumerate(datagrams) if names[index] in rows}
            limit = self._limits.get(peer)
            fitting = own if limit is None else self._fitting(own, limit, peer)
            for row in dict.fromkeys(names[index] for index in fitting) if self._limited else ():
                if limited := self._limited.get((destination, row or "")):
                    limited.take([fitting.pop(index) for index in [*fitting] if names[index] == row])
            self.hand_on([*fitting.values()], destination)

    def hand_on(self, datagrams: Sequence[bytes], destination: Destination) -> int:
        """Send datagrams that the end may get to its destination, in the form of the policy, and count them.

        Returns how many the network accepted.
        """
        return self._hand_on(datagrams, destination, self._send_raw if self._to_all else self._send)

    def hand_on_again(self, datagram: bytes, destination: Destination, row: str) -> int:
        """Send a datagram of a row once more, unless all datagrams are forwarded; return how many were sent."""
        sent = 0 if self._to_all else self._send([datagram], destination)
        self._counters.account.repeated[row] += sent
        return sent

    def withhold(self, destination: Destination, row: str, reason: str, count: int) -> None:
        """Count datagrams of a row that are not forwarded to an end."""
        if count:
            with self._counting:
                self._counters.account.withheld[destination.end.peer, row, reason] += count

    def _fitting(self, datagrams: Mapping[int, bytes], limit: int, peer: str) -> dict[int, bytes]:
        """Return the datagrams with at most ``limit`` bytes, and count the others."""
        for datagram in datagrams.values():
            if len(datagram) > limit:
                self._counters.count_unforwarded(peer, len(datagram), limit)
        return {index: datagram for index, datagram in datagrams.items() if len(datagram) <= limit}

    def _hand_on(self, datagrams: Sequence[bytes], destination: Destination, send: Send) -> int:
        if sent := send(datagrams, destination):
            with self._counting:  # the timekeeper forwards, too
                self._counters.account.forwarded[destination.end.peer] += sent
        return sent


class LimitedForward(LimitedRow):
    """Forward of one row to one end, with limits (table key ``forward``)."""

    def __init__(
        self, row: str, destination: Destination, limits: SendLimits, signature: int | None, forwarding: Forwarding
    ) -> None:
        """Hand on to ``forwarding`` what the limits let pass."""
        super().__init__(limits, signature)
        self.row, self.destination, self._forwarding = row, destination, forwarding

    def _count_superseded(self, count: int) -> None:
        self._forwarding.withhold(self.destination, self.row, "superseded", count)

    def _pass_on(self, datagrams: Sequence[bytes]) -> None:
        chosen = self._changed(datagrams)
        self._forwarding.withhold(self.destination, self.row, "unchanged", len(datagrams) - len(chosen))
        if self._forwarding.hand_on(chosen, self.destination) < len(chosen):
            self._not_sent()

    def _repeat(self, datagram: bytes) -> int:
        return self._forwarding.hand_on_again(datagram, self.destination, self.row)
