"""Forwarding of raw datagrams from peers to other peers (table key ``forward``)."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence

from roverlink.runtime.bridge.account import Account
from roverlink.runtime.core.registry import Registry
from roverlink.runtime.net.destination import Destination


class Forwarding:
    """Forwards datagrams to other peers: to those that the row names, or to all. To be used from one thread."""

    def __init__(
        self,
        registry: Registry,
        destinations: Mapping[str, Destination],
        policy: str,
        send: Callable[[Sequence[bytes], Destination], int],
        account: Account,
    ) -> None:
        """Select the peers that get a datagram.

        With the policy ``mapping`` these are the peers that the datagram's row names, with the policy ``all`` all
        peers.

        The function ``send`` returns how many datagrams it sent.
        """
        self._send, self._account = send, account
        self._to_all = tuple(destinations.values()) if policy == "all" else ()
        self._rows: defaultdict[Destination, set[str]] = defaultdict(set)
        for handler in registry.handlers if not self._to_all else ():
            for peer in handler.route.forward if handler.route.inbound else ():
                self._rows[destinations[peer]].add(handler.route.name)

    def forward(self, datagrams: Sequence[bytes], names: Sequence[str | None]) -> None:
        """Forward datagrams; ``names`` holds the payload name of each datagram, or None if the datagram was refused."""
        # One call for each peer: `Destination.send_all` sends runs of equal size with one system call.
        for destination, rows in self._rows.items():
            self._hand_on([datagram for datagram, name in zip(datagrams, names) if name in rows], destination)
        for destination in self._to_all:
            self._hand_on(datagrams, destination)

    def _hand_on(self, datagrams: Sequence[bytes], destination: Destination) -> None:
        if sent := self._send(datagrams, destination):
            self._account.forwarded[destination.peer] += sent
