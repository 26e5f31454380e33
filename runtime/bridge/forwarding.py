"""Forwarding of received datagrams, unchanged, from peers to other peers (table key ``forward``)."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence

from roverlink.runtime.bridge.account import Account
from roverlink.runtime.core.registry import Registry
from roverlink.runtime.net.destination import Destination


class Forwarding:
    """Forwarder of received datagrams to other peers: to the peers that the row names, or to all peers.

    Only one thread may call `forward`.
    """

    def __init__(
        self,
        registry: Registry,
        destinations: Mapping[str, Destination],
        policy: str,
        send: Callable[[Sequence[bytes], Destination], int],
        account: Account,
    ) -> None:
        """Forward to the peers' ``destinations``, given by the names of the peers.

        The ``policy`` is ``mapping`` (to the peers that the row names) or ``all`` (every datagram to every peer). The
        function ``send`` sends datagrams to a destination and returns how many the network accepted; ``account`` counts
        them.
        """
        self._send, self._account = send, account
        self._all = tuple(destinations.values())
        self._rows: defaultdict[Destination, set[str]] = defaultdict(set)
        for handler in registry.handlers:
            for peer in handler.route.forward if handler.route.inbound else ():
                self._rows[destinations[peer]].add(handler.route.name)
        self._refused: Mapping[str, frozenset[str]] = {}
        self.follow(policy)

    def refuse(self, rows: Mapping[str, frozenset[str]]) -> None:
        """Forward some rows no longer to some peers, which have another schema of them.

        ``rows`` has the names of all these rows by peer. Safe to call from any thread. The policy ``all`` forwards them
        all the same.
        """
        self._refused = rows

    def follow(self, policy: str) -> None:
        """Use a policy from now on: ``mapping`` forwards to the peers that the row names, ``all`` to every peer.

        Safe to call from any thread.
        """
        self._to_all = policy == "all"

    def forward(self, datagrams: Sequence[bytes], names: Sequence[str | None]) -> None:
        """Forward datagrams; ``names`` holds the payload name of each datagram, or None if the datagram was refused."""
        # One call for each peer: `Destination.send_all` sends runs of equal size with one system call.
        if self._to_all:
            for destination in self._all:
                self._hand_on(datagrams, destination)
            return
        for destination, rows in self._rows.items():
            if refused := self._refused.get(destination.peer):
                self._account.unforwarded[destination.peer] += sum(name in rows & refused for name in names)
                rows = rows - refused
            self._hand_on([datagram for datagram, name in zip(datagrams, names) if name in rows], destination)

    def _hand_on(self, datagrams: Sequence[bytes], destination: Destination) -> None:
        if sent := self._send(datagrams, destination):
            self._account.forwarded[destination.peer] += sent
