"""What becomes of datagrams where the table restricts who may speak: each sender has the payloads of its peers."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping

from roverlink.runtime.core.errors import DatagramError
from roverlink.runtime.core.registry import Registry
from roverlink.runtime.core.translator import Translator
from roverlink.runtime.net.sources import Address, SourceGate


class Admission:
    """Sorts datagrams by what their senders may say. For one thread."""

    def __init__(self, registry: Registry, drop: Callable[[DatagramError], None]) -> None:
        """``drop`` is told of what nobody may say."""
        self._registry, self._drop = registry, drop
        self._gate = SourceGate(registry.peers)
        self._translators: dict[frozenset[str], Translator] = {}

    def sort(self, batch: Iterable[tuple[bytes, Address]], now: float) -> Mapping[Translator, list[bytes]]:
        """The datagrams that are taken, by the translator that knows no more than their senders may say."""
        admitted: defaultdict[Translator, list[bytes]] = defaultdict(list)
        for datagram, source in batch:
            try:
                peers = self._gate.admit(source, now)
            except DatagramError as error:
                self._drop(error)
            else:
                admitted[self._translator(peers)].append(datagram)
        return admitted

    def _translator(self, peers: frozenset[str]) -> Translator:
        if peers not in self._translators:
            self._translators[peers] = Translator(self._registry, peers)
        return self._translators[peers]
