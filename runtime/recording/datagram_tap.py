"""Observer that passes the datagrams of a bridge to a recorder."""

from __future__ import annotations

from collections.abc import Sequence

from roverlink.runtime.bridge.handling_times import Handle
from roverlink.runtime.bridge.to_peer import Send
from roverlink.runtime.core.registry import Registry
from roverlink.runtime.net import udp
from roverlink.runtime.recording.recorder import Recorder


class DatagramTap:
    """Observer that records the datagrams that a bridge receives, and those that it makes from messages of topics.

    Datagrams that the bridge forwards are not recorded again.
    """

    def __init__(self, recorder: Recorder, registry: Registry) -> None:
        self.received = recorder.datagrams("received")
        """Function that records received datagrams."""
        self.sent = {peer.name: recorder.datagrams(f"sent/{peer.name}") for peer in registry.peers}
        """Function that records the datagrams to a peer, by the peer's name."""

    def receiving(self, handle: Handle) -> Handle:
        """Wrap ``handle`` so that each received batch is recorded before it is handled."""
        tap = self.received

        def received(batch: udp.Batch) -> None:
            # Before the bridge handles it: a datagram that makes the bridge fail is the one that somebody needs to see.
            tap(batch)
            handle(batch)

        return received

    def sending(self, peer: str, send: Send) -> Send:
        """Wrap ``send`` so that datagrams are recorded before they are sent."""
        tap = self.sent[peer]

        def made(datagrams: Sequence[bytes]) -> int:
            tap(datagrams)
            return send(datagrams)

        return made
