"""HTTP server that runs on its own threads, with limits for clients that are slow, silent or many.

A client that is slow must not keep others from an answer. Therefore the number of connections is limited, and with it
the number of threads. If the limit is reached, a new connection takes the place of the one that has been waiting
longest for the rest of its request. A request that is not complete in time ends its connection.
"""

from __future__ import annotations

import contextlib
import errno
import logging
import socket
import sys
import threading
import time
from enum import IntEnum
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, NamedTuple, TypeVar, cast

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.net.addresses import openable_host

Self = TypeVar("Self", bound="HttpServer")

_REQUEST_S = 10.0
"""Time in seconds in which a request must be complete, and after which an idle connection is closed."""
_SEND_S = 20.0
"""Time in seconds in which a client must accept what is sent to it; longer than an answer may wait for news."""
_EVICTION_S = 0.5  # a thread whose connection was ended needs some milliseconds to leave


class _Phase(IntEnum):
    """Phase of a connection. If there are too many connections, one of the lowest phase ends."""

    READING = 0
    """The client has not sent its whole request; or it has its answer, and has not sent the next request."""
    SENDING = 1
    """The client gets its answer."""
    WORKING = 2
    """The answer is being made. Its thread waits for no client, so ending the connection would free nothing."""


class _Activity(NamedTuple):
    phase: _Phase
    since: float


class BoundedServer(ThreadingHTTPServer):
    """HTTP server with a limited number of connections, each with its own thread."""

    connections = 64
    """Most connections at a time; a browser opens six."""
    request_queue_size = 256
    """Connections that may wait to be accepted. If it is small, a burst of clients delays the others by seconds."""

    def __init__(self, *given: Any) -> None:
        self._free = threading.BoundedSemaphore(self.connections)
        self._active: dict[socket.socket, _Activity] = {}
        self._lock = threading.Lock()
        super().__init__(*given)

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answer a connection on a new thread. If there are too many, end another one, or else this one."""
        if not self._free.acquire(blocking=False) and not (self._evict() and self._free.acquire(timeout=_EVICTION_S)):
            self.shutdown_request(request)
            return
        with self._lock:
            self._active[request] = _Activity(_Phase.READING, time.monotonic())
        try:
            super().process_request(request, client_address)
        except RuntimeError:  # the system has no thread for it
            self._leave(request)
            self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Answer a connection; `process_request` starts this as a thread."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._leave(request)

    def shutdown_request(self, request: Any) -> None:
        """Close a connection."""
        with self._lock:  # before it is closed: only an open socket may be in the list
            self._active.pop(request, None)
        super().shutdown_request(request)

    def _leave(self, request: Any) -> None:
        with self._lock:
            self._active.pop(request, None)
        self._free.release()

    def enter(self, request: Any, phase: _Phase) -> bool:
        """Record that a connection enters a phase; return false if the server has ended the connection."""
        with self._lock:
            if is_open := request in self._active:
                self._active[request] = _Activity(phase, time.monotonic())
        return is_open

    def _evict(self) -> bool:
        """End the connection that waits longest for its client; return false if all threads are making answers."""
        with self._lock:
            waiting = [request for request, active in self._active.items() if active.phase != _Phase.WORKING]
            oldest = min(waiting, key=lambda request: self._active[request], default=None)
            if oldest is None:
                return False
            self._end(oldest)
        return True

    def service_actions(self) -> None:
        """End the connections whose requests are late; `serve_forever` calls this several times a second."""
        latest = _Activity(_Phase.READING, time.monotonic() - _REQUEST_S)
        with self._lock:
            for request in [request for request, active in self._active.items() if active < latest]:
                self._end(request)

    def end_connections(self) -> None:
        """End all connections, so that no thread waits for a client."""
        with self._lock:
            for request in list(self._active):
                self._end(request)

    def _end(self, request: socket.socket) -> None:
        """End a connection, which wakes the thread that waits for it; this thread closes the socket."""
        del self._active[request]
        with contextlib.suppress(OSError):  # the client was faster
            request.shutdown(socket.SHUT_RDWR)

    def handle_error(self, request: Any, client_address: Any) -> None:  # noqa: ARG002  # part of the base's interface
        """Log why a client got no answer; one that has closed its connection, or that is too slow, is no error."""
        if not isinstance(error := sys.exc_info()[1], OSError):
            logging.getLogger("roverlink").error(
                "no answer to a request from %s: %s: %s", client_address[0], type(error).__name__, error
            )


class _Limited(BaseHTTPRequestHandler):
    """Part of every handler of a `BoundedServer`: tells the server in which phase its connection is."""

    timeout = _SEND_S

    def handle_one_request(self) -> None:
        self._enter(_Phase.READING)
        super().handle_one_request()

    def parse_request(self) -> bool:
        # http.server takes half a request for a whole one if the connection has ended; nobody waits for its answer.
        return super().parse_request() and self._enter(_Phase.WORKING)

    def send_response(self, code: int, message: str | None = None) -> None:
        self._enter(_Phase.SENDING)
        super().send_response(code, message)

    def log_message(self, *_: object) -> None:
        """Log nothing. The base class would log each request and each late client on standard error."""

    def _enter(self, phase: _Phase) -> bool:
        return cast("BoundedServer", self.server).enter(self.connection, phase)


class HttpServer:
    """HTTP server that accepts requests on one thread, and answers each connection on another thread.

    A context manager: the server accepts requests inside the block.
    """

    def __init__(self, address: str, port: int, what: str, handler: type[BaseHTTPRequestHandler]) -> None:
        """Bind the port; for port 0, the system selects a free port.

        ``what`` names the served content in errors, such as ``metrics``. ``handler`` answers the requests. It must call
        ``send_response`` after all work for the answer is done. Raises `SetupError` if the port is not available.
        """
        limited = type(handler.__name__, (_Limited, handler), {})
        try:
            self._server = BoundedServer((address, port), limited)
        except (OSError, OverflowError) as error:
            in_use = isinstance(error, OSError) and error.errno == errno.EADDRINUSE
            reason = "another program uses it; stop that program or choose another port" if in_use else error
            raise SetupError(f"cannot serve the {what} on TCP port {port} of {address}: {reason}") from error
        self.port: int = self._server.server_address[1]
        self.url = f"http://{openable_host(address)}:{self.port}/"
        """URL that a browser can open."""
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.1,), name=what, daemon=True)

    def __enter__(self: Self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._server.shutdown()
        self._server.server_close()
        self._server.end_connections()
        self._thread.join()
