"""Access control by sender address: to which peers an address belongs, and how many datagrams a second it may send.

The functions get addresses as bytes, and times in seconds of a monotonic clock. Memory is bounded: only a limited
number of addresses of known peers is stored, and other addresses never are. So a sender that forges addresses cannot
exhaust the memory.
"""

from __future__ import annotations

import ctypes
import math
from collections import OrderedDict
from collections.abc import Callable, Iterable
from ipaddress import ip_address, ip_network

from roverlink.numerals import counted
from roverlink.runtime.core.errors import DatagramError, Reason
from roverlink.runtime.core.registry import Peer

_REMEMBERED = 4096  # addresses; a forgotten one starts again with a full allowance
# A board that was busy sends what it has at once. A quarter of a second of its rate passes, and at least some
# datagrams.
_BURST_S = 0.25
_SMALLEST_BURST = 32

Address = bytes
"""IP address in network order: four bytes for IPv4, sixteen for IPv6."""


def restricts_sources(peers: Iterable[Peer]) -> bool:
    """Return true if the table restricts the senders of any peer (table key ``sources``)."""
    return any(peer.sources for peer in peers)


class Source(ctypes.Structure):
    """Sender address that belongs to peers, with a token bucket that limits the rate of the sender's datagrams.

    The native core takes tokens, too, from the same memory (`rl_bucket` in bridge.h).
    """

    _fields_ = tuple((name, ctypes.c_double) for name in ("rate", "burst", "allowance", "at"))
    rate: float
    """Datagrams a second; infinity for no limit."""
    burst: float
    """Largest number of datagrams that may arrive at once."""
    allowance: float
    """Number of datagrams that may arrive now, in tokens of the bucket."""
    at: float
    """Time of the last change of the allowance."""

    def __init__(self, peers: frozenset[str], rate: float, now: float) -> None:
        burst = max(_SMALLEST_BURST, rate * _BURST_S)
        super().__init__(rate, burst, burst, now)
        self.peers = peers

    def take_token(self, now: float) -> bool:
        """Take one token from the bucket at the time ``now``; return false if the bucket is empty."""
        if self.rate == math.inf:
            return True
        # Token bucket: tokens flow in at `rate`, and at most `burst` are kept.
        self.allowance = min(self.burst, self.allowance + (now - self.at) * self.rate)
        self.at = now
        if self.allowance < 1:
            return False
        self.allowance -= 1
        return True


UNLIMITED = Source(frozenset(), math.inf, 0)
"""Sender of a bridge that restricts none."""


class SourceGate:
    """Gate that accepts or refuses a datagram by the address of its sender. To be used from one thread."""

    def __init__(self, peers: Iterable[Peer]) -> None:
        self._peers = tuple(peers)
        self._networks = [
            (peer.name, len(network.netmask.packed), int(network.network_address), int(network.netmask))
            for peer in self._peers
            for network in map(ip_network, peer.sources)
        ]
        self._unrestricted = {peer.name for peer in self._peers if not peer.sources}
        self._known: OrderedDict[Address, Source] = OrderedDict()
        self.on_forgotten: Callable[[], None] = lambda: None
        """Function that is called when a sender was forgotten."""

    def admit(self, address: Address, now: float) -> frozenset[str]:
        """Return the names of the peers to which a sender's address belongs.

        They include every peer without ``sources`` in the table, because such a peer may have any address. ``now`` is
        in seconds of a monotonic clock. Raises `DatagramError` if the address belongs to no peer, or if it sends more
        datagrams a second than the table allows.
        """
        source = self._known.get(address)
        if source is None:
            source = self._add(address, now)
        else:
            self._known.move_to_end(address)
        if not source.take_token(now):
            raise DatagramError(
                Reason.OVER_RATE, f"{ip_address(address)} sends more than {counted(source.rate, 'datagram')} a second"
            )
        return source.peers

    def source(self, address: Address, peer: str) -> Source | None:
        """Return the sender with an address if `admit` lets datagrams of a peer pass from it, at its rate."""
        source = self._known.get(address)
        return source if source is not None and peer in source.peers else None

    def _add(self, address: Address, now: float) -> Source:
        number, length = int.from_bytes(address, "big"), len(address)
        named = {name for name, size, network, mask in self._networks if size == length and number & mask == network}
        peers = named | self._unrestricted
        if not peers:
            raise DatagramError(Reason.UNKNOWN_SOURCE, f"{ip_address(address)} is not among the sources of any peer")
        rates = [peer.source_rate or math.inf for peer in self._peers if peer.name in named]
        rate = max(rates, default=math.inf)  # an address of several peers gets the highest of their rates
        source = self._known[address] = Source(frozenset(peers), rate, now)
        # The least recently used address goes: `move_to_end` above keeps the order of use.
        if len(self._known) > _REMEMBERED:
            self._known.popitem(last=False)
            self.on_forgotten()
        return source
