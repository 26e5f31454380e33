"""Observer that passes a bridge's datagrams to a recorder."""

from __future__ import annotations

from collections.abc import Sequence

from roverlink.runtime.bridge.bridge import Handle
from roverlink.runtime.bridge.to_peer import Send
from roverlink.runtime.core.registry import Registry
from roverlink.runtime.net import udp
from roverlink.runtime.recording.recorder import Recorder


class DatagramTap:
    """Records datagrams that a bridge receives or makes for peers, but not those that it forwards."""

    def __init__(self, recorder: Recorder, registry: Registry) -> None:
        self._received = recorder.datagrams("received")
        self._sent = {peer.name: recorder.datagrams(f"sent/{peer.name}") for peer in registry.peers}

    def receiving(self, handle: Handle) -> Handle:
        """Record each batch before it is handled."""
        tap = self._received

        def received(batch: udp.Batch) -> None:
            # Before the bridge handles it: a datagram that makes the bridge fail is the one that somebody needs to see.
            tap(batch)
            handle(batch)

        return received

    def sending(self, peer: str, send: Send) -> Send:
        """Record datagrams before they are sent."""
        tap = self._sent[peer]

        def made(datagrams: Sequence[bytes]) -> int:
            tap(datagrams)
            return send(datagrams)

        return made
