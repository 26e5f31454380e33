"""Access control by sender: it may send only the payloads of the ends to which its address or its line belongs."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from ipaddress import ip_address

from roverlink.runtime.core.errors import DatagramError, Reason
from roverlink.runtime.core.handler import Route
from roverlink.runtime.core.principals import Origin
from roverlink.runtime.core.registry import EndName, Registry
from roverlink.runtime.core.translator import Translator
from roverlink.runtime.net.hosts import Sender, SocketAddress
from roverlink.runtime.net.sources import UNLIMITED, Source, SourceGate
from roverlink.runtime.net.udp import SentDatagram


class Admission:
    """Selector of a `Translator` for each datagram, by its sender. To be used from one thread.

    The translator accepts only payloads that may come from this sender.
    """

    def __init__(
        self,
        registry: Registry,
        drop: Callable[[DatagramError], None],
        translator: Callable[[Origin], Translator],
    ) -> None:
        """Prepare the access control.

        ``drop`` is called for every datagram that its sender may not send. ``translator`` makes the translator for the
        payloads that may have an origin.
        """
        self._registry, self._make, self._drop = registry, translator, drop
        self.gate = SourceGate(registry.peers)
        self._lines: Mapping[SocketAddress, EndName] = {}
        self._ends_with_lines: frozenset[EndName] = frozenset()
        self._translators: dict[Origin, Translator] = {}
        self._refused: frozenset[str] = frozenset()

    def follow(self, lines: Mapping[SocketAddress, EndName]) -> None:
        """Believe the ends that have lines only over these from now on; ``lines`` has the address of each carrier.

        Safe to call from any thread.
        """
        ends = frozenset(lines.values())
        whole = {
            EndName(peer.name)
            for peer in self._registry.peers
            if ends >= {end for end in self._registry.ends if end.peer == peer.name}
        }
        self._lines, self._ends_with_lines = lines, ends | whole

    def refuse(self, rows: frozenset[str]) -> None:
        """Refuse the payloads of some rows from now on, as `Translator.refuse` does."""
        self._refused = rows
        for translator in tuple(self._translators.values()):
            translator.refuse(rows)

    def sort(self, batch: Iterable[SentDatagram], now: float) -> Mapping[Translator, list[bytes]]:
        """Group the admitted datagrams of a batch by translator.

        A translator accepts only the payloads that may come from the sender. ``now`` is in seconds of a monotonic
        clock.
        """
        admitted: defaultdict[Translator, list[bytes]] = defaultdict(list)
        for datagram, sender in batch:
            try:
                origin = self._origin(sender, now)
            except DatagramError as error:
                self._drop(error)
            else:
                admitted[self._translator(origin)].append(datagram)
        return admitted

    def settled(self, route: Route, sender: Sender) -> Source | None:
        """Return a sender whose datagrams of a row need no decision but their rate; None if they need one."""
        if (end := self._lines.get(sender.address)) is not None:
            return UNLIMITED if Origin(frozenset(), end).may_carry(route.peer, route.board) else None
        source = self.gate.source(sender.ip, route.peer)
        return source if source and self._of_network(source.peers).may_carry(route.peer, route.board) else None

    def _origin(self, sender: Sender, now: float) -> Origin:
        if (end := self._lines.get(sender.address)) is not None:
            return Origin(frozenset(), end)
        origin = self._of_network(self.gate.admit(sender.ip, now))
        if not origin.peers:
            raise DatagramError(Reason.UNKNOWN_SOURCE, f"{ip_address(sender.ip)} is not the line of any peer")
        return origin

    def _of_network(self, peers: frozenset[str]) -> Origin:
        ends = self._ends_with_lines
        return Origin(peers - {peer for peer, board in ends if not board}, lines=ends)

    def _translator(self, origin: Origin) -> Translator:
        # Senders with the same origin share a translator, so there are at most as many as there are sets of peers.
        if origin not in self._translators:
            self._translators[origin] = self._make(origin)
            self._translators[origin].refuse(self._refused)
        return self._translators[origin]
