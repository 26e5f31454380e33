"""Peer for programs without asyncio. It uses one socket and no thread."""

from __future__ import annotations

import math
import selectors
import time
from collections.abc import Iterator
from itertools import islice
from typing import Any, TypeVar, cast, overload

from roverlink.runtime.client.peer_end import PeerEnd
from roverlink.runtime.client.reassembly import Frame, Part, Reassembler
from roverlink.runtime.client.session import Received
from roverlink.runtime.net import udp
from roverlink.transport_addresses import names_transport

P = TypeVar("P")
F = TypeVar("F", bound=Part)

_MOST_BATCHES = 16  # read in one go: a flood must not keep the program from its payloads


class BlockingPeer(PeerEnd):
    """Peer of a bridge: sends payloads, and waits for those of the bridge.

        with BlockingPeer.open("basestation", host="10.0.0.5") as peer:
            peer.send(BasestationControlMode(mode=MODE_AUTO))
            for number, payload in peer:
                ...

    Repeated payloads are sent only while the program is in a method of this class. A program that hangs therefore sends
    no commands.
    """

    def __enter__(self) -> BlockingPeer:
        if not names_transport(self._remote[0]):
            self.direct_to(*self._remote)
        sock = self._bind()
        if self._carrier is not None:
            self._carrier.wait()
        self._read = udp.reader(sock, udp.LARGEST)
        self._selector = selectors.DefaultSelector()
        self._selector.register(sock, selectors.EVENT_READ)
        self._start()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the socket and end the repetitions; iterations end. May be repeated."""
        if self._socket is not None:
            self._selector.close()
            sock = self._socket
            self._forget_socket()
            sock.close()

    def direct_to(self, host: str, port: int) -> None:
        """Send to this address from now on. Raises `SetupError` if the host does not resolve."""
        self._remote = udp.resolve(host, port)

    @overload
    def receive(self, payload_type: None = None, timeout: float | None = None) -> Received: ...
    @overload
    def receive(self, payload_type: type[P], timeout: float | None = None) -> P: ...
    def receive(self, payload_type: type[P] | None = None, timeout: float | None = None) -> Received | P:
        """Return the next payload with its number; with ``payload_type``, the next payload of this class alone.

        Payloads of other classes wait for another call. Raises `TimeoutError` after ``timeout`` seconds; None waits for
        ever. Raises `ClosedError` if the peer is not open.
        """
        deadline = math.inf if timeout is None else time.monotonic() + timeout
        while (received := self._take(payload_type)) is None:
            now = time.monotonic()
            if now >= deadline:
                raise TimeoutError(f"no payload has arrived for {timeout:g} s")
            self._selector.select(_until(min(deadline, self._schedule.next_due), now))
        return received if payload_type is None else cast("P", received.payload)

    def arrived(self) -> list[Received]:
        """Return the payloads that have arrived, oldest first, without waiting. For programs with a loop of their own.

        Call it regularly if payloads are repeated. Raises `ClosedError` if the peer is not open.
        """
        first = self._take()
        return [] if first is None else [first, *iter(self._session.take, None)]

    def __iter__(self) -> Iterator[Received]:
        """Yield the payloads that arrive, until the peer is closed."""
        self._opened()
        while self._socket is not None:
            yield self.receive()

    def frames(self, payload_type: type[F]) -> Iterator[Frame[F]]:
        """Yield the complete frames of a row whose payloads are parts of frames, until the peer is closed."""
        self._opened()
        reassembler = Reassembler[F]()
        while self._socket is not None:
            if (frame := reassembler.add(self.receive(payload_type))) is not None:
                yield frame

    def _take(self, payload_type: type[Any] | None = None) -> Received | None:
        """Do all that is due: send repeated payloads, and take in what has arrived. Then return the oldest payload."""
        self._opened()
        self._send_due()
        # Before the queue is served: a full queue drops its oldest payloads, but the kernel would drop the newest ones.
        for batch in islice(iter(self._read, []), _MOST_BATCHES):
            for datagram in batch:
                self._session.take_in(datagram)
        return self._session.take(payload_type)

    def _wait_for_due(self) -> None:
        """Do nothing: `receive` wakes up in time."""


def _until(due: float, now: float) -> float | None:
    """Return the seconds to wait until a time; None to wait for ever."""
    return None if due == math.inf else max(0.0, due - now)
