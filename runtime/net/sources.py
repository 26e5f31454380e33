"""Who may speak: for which peers an address speaks, and how much of it is taken.

No socket, no clock: an address is its four bytes, a time is in seconds of a clock that never goes back. What is known
of addresses is bounded; strangers are not remembered at all.
"""

from __future__ import annotations

import math
import socket
from collections import OrderedDict
from collections.abc import Iterable
from dataclasses import dataclass
from ipaddress import IPv4Network

from roverlink.runtime.core.errors import DatagramError, Reason
from roverlink.runtime.core.registry import Peer

_REMEMBERED = 4096  # addresses; what is taken of one that was forgotten starts anew
_BURST_S = 0.25
_SMALLEST_BURST = 32

Address = bytes
"""An IPv4 address, four bytes."""


def restrict(peers: Iterable[Peer]) -> bool:
    """Whether the table says anything about who may speak."""
    return any(peer.sources for peer in peers)


@dataclass(slots=True)
class _Source:
    """An address that may speak."""

    peers: frozenset[str]
    rate: float
    """Datagrams a second; infinity for any number."""
    burst: float
    allowance: float
    at: float
    """When the allowance was reckoned."""

    def may_speak(self, now: float) -> bool:
        """Whether one more datagram is taken; it is then counted."""
        if self.rate == math.inf:
            return True
        self.allowance = min(self.burst, self.allowance + (now - self.at) * self.rate)
        self.at = now
        if self.allowance < 1:
            return False
        self.allowance -= 1
        return True


class SourceGate:
    """Decides by the address that a datagram comes from. For one thread."""

    def __init__(self, peers: Iterable[Peer]) -> None:
        self._peers = tuple(peers)
        self._networks = [
            (peer.name, int(network.network_address), int(network.netmask))
            for peer in self._peers
            for network in map(IPv4Network, peer.sources)
        ]
        self._anywhere = {peer.name for peer in self._peers if not peer.sources}
        self._known: OrderedDict[Address, _Source] = OrderedDict()

    def admit(self, address: Address, now: float) -> frozenset[str]:
        """The peers for which an address speaks.

        Raises `DatagramError` where it speaks for none, or has sent more than is taken of it.
        """
        source = self._known.get(address)
        if source is None:
            source = self._meet(address, now)
        else:
            self._known.move_to_end(address)
        if not source.may_speak(now):
            raise DatagramError(
                Reason.OVER_RATE, f"{socket.inet_ntoa(address)} sends more than {source.rate:g} datagrams a second"
            )
        return source.peers

    def _meet(self, address: Address, now: float) -> _Source:
        number = int.from_bytes(address, "big")
        named = {name for name, network, mask in self._networks if number & mask == network}
        peers = named | self._anywhere
        if not peers:
            raise DatagramError(Reason.UNKNOWN_SOURCE, f"{socket.inet_ntoa(address)} is no source of any peer")
        rates = [peer.source_rate or math.inf for peer in self._peers if peer.name in named]
        rate = max(rates, default=math.inf)  # an address of several peers has what the most generous of them has
        burst = max(_SMALLEST_BURST, rate * _BURST_S)
        source = self._known[address] = _Source(frozenset(peers), rate, burst, burst, now)
        if len(self._known) > _REMEMBERED:
            self._known.popitem(last=False)
        return source
