"""Access control by sender address: a sender may send only the payloads of the peers that have the sender's address."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping

from roverlink.runtime.core.errors import DatagramError
from roverlink.runtime.core.registry import Registry
from roverlink.runtime.core.translator import Translator
from roverlink.runtime.net.sources import Address, SourceGate


class Admission:
    """Selector of a `Translator` for each datagram, by the address of its sender. To be used from one thread.

    The translator accepts only payloads of the peers to which the address belongs.
    """

    def __init__(
        self,
        registry: Registry,
        drop: Callable[[DatagramError], None],
        translator: Callable[[frozenset[str]], Translator],
    ) -> None:
        """Prepare the access control.

        ``drop`` is called for every datagram that its sender may not send. ``translator`` makes the translator for the
        payloads of some peers.
        """
        self._make, self._drop = translator, drop
        self.gate = SourceGate(registry.peers)
        self._translators: dict[frozenset[str], Translator] = {}
        self._refused: frozenset[str] = frozenset()

    def refuse(self, rows: frozenset[str]) -> None:
        """Refuse the payloads of some rows from now on, as `Translator.refuse` does."""
        self._refused = rows
        for translator in tuple(self._translators.values()):
            translator.refuse(rows)

    def sort(self, batch: Iterable[tuple[bytes, Address]], now: float) -> Mapping[Translator, list[bytes]]:
        """Group the admitted datagrams of a batch by translator.

        A translator accepts only the payloads of the peers that have the sender's address. ``now`` is in seconds of a
        monotonic clock.
        """
        admitted: defaultdict[Translator, list[bytes]] = defaultdict(list)
        for datagram, source in batch:
            try:
                peers = self.gate.admit(source, now)
            except DatagramError as error:
                self._drop(error)
            else:
                admitted[self._translator(peers)].append(datagram)
        return admitted

    def _translator(self, peers: frozenset[str]) -> Translator:
        # Senders with the same peers share a translator, so there are at most as many as there are sets of peers.
        if peers not in self._translators:
            self._translators[peers] = self._make(peers)
            self._translators[peers].refuse(self._refused)
        return self._translators[peers]
