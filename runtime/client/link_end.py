"""Link messages of a peer: they tell the bridge which schemas the peer has, and measure the link."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from roverlink.runtime.core import link_message
from roverlink.runtime.core.link_message import LinkWriter
from roverlink.runtime.core.link_statistics import LinkStatistics
from roverlink.runtime.core.registry import EndName, Registry

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage

PERIOD_S = link_message.PERIOD_S


class LinkEnd:
    """Peer's end of the exchange of link messages with a bridge."""

    def __init__(self, registry: Registry, end: EndName) -> None:
        """Speak for the peer or board ``end``. The table must have the link message."""
        assert registry.link is not None, "the session checks this first"  # noqa: S101  # for mypy
        self.number = registry.link.number
        self.statistics = LinkStatistics()
        """Statistics of the link, of this start of the bridge."""
        self._registry, self._hashes = registry, registry.link.hashes
        self._began_ns = time.time_ns() - time.monotonic_ns()
        spoken = {number: self._hashes[number] for number in link_message.rows_in_turn(registry, end)}
        self._writer = LinkWriter(registry.envelope, link_message.new_session(), spoken)
        self._written = b""
        self._bridge_session = 0
        self._differing: set[int] = set()
        self._received = 0

    @property
    def differing(self) -> tuple[str, ...]:
        """Names of the rows of which the bridge has another schema, sorted."""
        return tuple(sorted(self._registry.by_number[number].route.name for number in self._differing))

    def write(self) -> bytes:
        """Return the next link message to send."""
        self._written = self._writer.write(self._now_us())
        return self._written

    def count_sent(self, datagram: bytes) -> None:
        """Count a datagram that is sent to the bridge. The link message itself is counted when it is written."""
        if datagram is not self._written:
            self._writer.count_sent(1)

    def count_received(self) -> None:
        """Count a datagram of the bridge that is no link message."""
        self._received += 1

    def take(self, payload: ProtoMessage) -> None:
        """Take a link message of the bridge."""
        message, now_us = link_message.read(payload), self._now_us()
        if message.session != self._bridge_session:  # the bridge has started again, and counts from the beginning
            self._bridge_session, self._received = message.session, 0
            self.statistics, self._differing = LinkStatistics(), set()
        for number, hash in message.hashes.items():
            if number in self._hashes:
                (self._differing.discard if hash == self._hashes[number] else self._differing.add)(number)
        duplicate = self.statistics.is_duplicate(message)
        self.statistics.take(message, now_us, self._received, self._writer.sent_before(message.echo_us))
        if not duplicate:
            self._writer.note_heard(message, now_us, self._received)
            self._received += 1

    def _now_us(self) -> int:
        # It starts at the system's time, so that the bridge can tell how far the two clocks are apart.
        return (self._began_ns + time.monotonic_ns()) // 1000
