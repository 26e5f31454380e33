"""Clients of a stream of server-sent events: each has a bounded queue, and a client that does not read is dropped."""

from __future__ import annotations

import contextlib
import queue
import socket
import threading
from collections.abc import Mapping

CLIENTS = 30
"""Most clients at a time."""
_QUEUE = 16  # events; about five seconds
_SEND_BUFFER = 131_072  # bytes that the kernel holds for a client


class EventClient:
    """One browser that follows the events of a bridge, and those of the whole page."""

    def __init__(self, connection: socket.socket, bridge: str) -> None:
        self._connection, self.bridge = connection, bridge
        # Linux would hold megabytes for a client that does not read.
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _SEND_BUFFER)
        self._events: queue.Queue[bytes] = queue.Queue(_QUEUE)
        self._ended = False

    def offer(self, event: bytes) -> bool:
        """Queue an event and return true; if the queue is full, end the connection and return false."""
        try:
            self._events.put_nowait(event)
        except queue.Full:
            self.end()
            return False
        return True

    def next_event(self, timeout_s: float) -> bytes | None:
        """Return the next event; empty bytes if none comes in time, None at the end."""
        try:
            event = self._events.get(timeout=timeout_s)
        except queue.Empty:
            event = b""
        return None if self._ended else event

    def end(self) -> None:
        """End the connection; the thread that serves the client ends then."""
        self._ended = True
        with contextlib.suppress(OSError):  # the browser, or that thread, was faster
            self._connection.shutdown(socket.SHUT_RDWR)


class EventClients:
    """All browsers that follow the events. Safe to use from several threads; sending never waits for a client."""

    def __init__(self) -> None:
        self._clients: set[EventClient] = set()
        self._lock = threading.Lock()

    def add(self, connection: socket.socket, bridge: str) -> EventClient | None:
        """Return a new client that follows the bridge with the id ``bridge``; None if there are too many."""
        with self._lock:
            if len(self._clients) >= CLIENTS:
                return None
            client = EventClient(connection, bridge)
            self._clients.add(client)
            return client

    def remove(self, client: EventClient) -> None:
        """Forget a client that has gone."""
        with self._lock:
            self._clients.discard(client)

    def followed(self) -> set[str]:
        """Return the ids of the bridges that the clients follow."""
        with self._lock:
            return {client.bridge for client in self._clients}

    def send(self, to_all: bytes, by_bridge: Mapping[str, bytes]) -> None:
        """Send each client the events for all clients and those of its bridge; drop clients whose queues are full."""
        with self._lock:
            clients = list(self._clients)
        for client in clients:
            # In one piece, because each piece wakes a thread, and the bridge waits for these threads.
            event = to_all + by_bridge.get(client.bridge, b"")
            if event and not client.offer(event):
                self.remove(client)

    def end(self) -> None:
        """End all clients."""
        with self._lock:
            for client in self._clients:
                client.end()
            self._clients.clear()
