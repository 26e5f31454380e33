"""Forwarding of received datagrams from peers to other peers (table key ``forward``).

A row's datagrams reach the other peers as the protobuf library writes an envelope. Some boards append zeros to their
datagrams, and others strip zeros from them; strict decoders, such as those of prost and upb, refuse both.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence

from roverlink.runtime.bridge.counters import Counters
from roverlink.runtime.bridge.ends import Ends
from roverlink.runtime.core.registry import EndName, Registry
from roverlink.runtime.net.destination import Destination

Send = Callable[[Sequence[bytes], Destination], int]
"""Function that sends datagrams to a destination and returns how many of them the network accepted."""


class Forwarding:
    """Forwarder of received datagrams to other peers: to the peers that the row names, or to all peers.

    A peer with boards gets the datagrams at each of its boards. Only one thread may call `forward`.
    """

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
        for handler in registry.handlers:
            for peer in handler.route.forward if handler.route.inbound else ():
                for destination in ends.of_peer(peer):
                    self._rows[destination].add(handler.route.name)
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
            own = [datagram for datagram, name in zip(datagrams, names) if name in rows]
            limit = self._limits.get(peer)
            fitting = own if limit is None else self._fitting(own, limit, peer)
            self.hand_on(fitting, destination)

    def hand_on(self, datagrams: Sequence[bytes], destination: Destination) -> None:
        """Send datagrams that the end may get to its destination, in the form of the policy, and count them."""
        self._hand_on(datagrams, destination, self._send_raw if self._to_all else self._send)

    def _fitting(self, datagrams: Sequence[bytes], limit: int, peer: str) -> list[bytes]:
        """Return the datagrams with at most ``limit`` bytes, and count the others."""
        for datagram in datagrams:
            if len(datagram) > limit:
                self._counters.count_unforwarded(peer, len(datagram), limit)
        return [datagram for datagram in datagrams if len(datagram) <= limit]

    def _hand_on(self, datagrams: Sequence[bytes], destination: Destination, send: Send) -> None:
        if sent := send(datagrams, destination):
            self._counters.account.forwarded[destination.end.peer] += sent
