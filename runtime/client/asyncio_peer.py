"""Peer for asyncio. It uses one socket and no thread, except that asyncio looks up the name of the bridge in one."""

from __future__ import annotations

import asyncio
import contextlib
import math
import time
from collections.abc import AsyncIterator, Callable
from typing import TYPE_CHECKING, Any, TypeVar, cast, overload

from roverlink.runtime.client.peer_end import PeerEnd
from roverlink.runtime.client.reassembly import Frame, Part, Reassembler
from roverlink.runtime.client.session import ClosedError, Received
from roverlink.runtime.core.errors import RoverlinkError
from roverlink.runtime.net import udp
from roverlink.transport_addresses import names_transport

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage

P = TypeVar("P")
F = TypeVar("F", bound=Part)


class Peer(PeerEnd):
    """Peer of a bridge: sends payloads, and waits for those of the bridge. Use it from the thread of one event loop.

        async with Peer.open("basestation", host="10.0.0.5") as peer:
            peer.send(BasestationControlMode(mode=MODE_AUTO))
            async for number, payload in peer:
                ...

    Several tasks may wait for payloads of different classes.
    """

    async def __aenter__(self) -> Peer:
        self._loop = loop = asyncio.get_running_loop()
        if not names_transport(self._remote[0]):
            self._remote = await loop.run_in_executor(None, udp.resolve, *self._remote)
        self._news = asyncio.Event()
        self._timer: asyncio.TimerHandle | None = None
        self._transport, self._arrivals = await loop.create_datagram_endpoint(
            lambda: _Arrivals(self._take_in), sock=self._bind()
        )
        if self._carrier is not None:
            await loop.run_in_executor(None, self._carrier.wait)
        self._start()
        return self

    async def __aexit__(self, *_: object) -> None:
        self.close()
        await self._arrivals.ended.wait()

    def close(self) -> None:
        """Close the socket and end the repetitions; iterations end. May be repeated."""
        if self._socket is None:
            return
        self._forget_socket()
        self._wait_for_due()
        self._transport.close()
        self._news.set()

    @overload
    async def receive(self, payload_type: None = None) -> Received: ...
    @overload
    async def receive(self, payload_type: type[P]) -> P: ...
    async def receive(self, payload_type: type[P] | None = None) -> Received | P:
        """Return the next payload with its number; with ``payload_type``, the next payload of this class alone.

        Payloads of other classes wait for another call. Raises `ClosedError` if the peer is not open, or is closed
        meanwhile. `asyncio.wait_for` limits the time.
        """
        while True:
            self._opened()
            if (received := self._session.take(payload_type)) is not None:
                return received if payload_type is None else cast("P", received.payload)
            self._news.clear()
            await self._news.wait()

    async def request(self, payload: ProtoMessage, row: str | None = None) -> Any:
        """Send a payload whose row is a request, again and again until it is answered, and return the response.

        Raises `UnansweredError` if no response comes, `ClosedError` if the peer is closed meanwhile, and the errors of
        `send`, but no `OSError`: a later datagram may get through. A request that is cancelled is not sent any more.
        """
        response = asyncio.get_running_loop().create_future()

        def done(result: ProtoMessage | RoverlinkError) -> None:
            if response.done():  # it was cancelled just now
                return
            if isinstance(result, RoverlinkError):
                response.set_exception(result)
            else:
                response.set_result(result)

        self._ask(payload, row, done)
        try:
            return await response
        finally:
            self._session.requests.cancel(done, time.monotonic())
            self._wait_for_due()  # the next one may be due earlier than this one was

    async def __aiter__(self) -> AsyncIterator[Received]:
        """Yield the payloads that arrive, until the peer is closed."""
        self._opened()
        with contextlib.suppress(ClosedError):
            while True:
                yield await self.receive()

    async def frames(self, payload_type: type[F]) -> AsyncIterator[Frame[F]]:
        """Yield the complete frames of a row whose payloads are parts of frames, until the peer is closed."""
        self._opened()
        reassembler = Reassembler[F]()
        with contextlib.suppress(ClosedError):
            while True:
                if (frame := reassembler.add(await self.receive(payload_type))) is not None:
                    yield frame

    def _take_in(self, datagram: bytes) -> None:
        """Take in a datagram, and wake the tasks that wait for one."""
        now = time.monotonic()
        self._session.take_in(datagram, now)
        self._news.set()
        if self._session.requests.next_due <= now and self._socket is not None:  # the response lets the next one go
            self._send_due()

    def _wait_for_due(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
        if (due := self._next_due) < math.inf:
            self._timer = self._loop.call_later(max(0.0, due - time.monotonic()), self._send_due)


class _Arrivals(asyncio.DatagramProtocol):
    """Receiver of asyncio's datagrams for a peer."""

    def __init__(self, take_in: Callable[[bytes], None]) -> None:
        self._take_in = take_in
        self.ended = asyncio.Event()

    def datagram_received(self, data: bytes, addr: Any) -> None:  # noqa: ARG002
        """Pass the datagram on."""
        self._take_in(data)

    def connection_lost(self, exc: Exception | None) -> None:  # noqa: ARG002
        """Tell that the socket is closed."""
        self.ended.set()
