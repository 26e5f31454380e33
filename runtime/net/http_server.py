"""HTTP server that runs on its own threads."""

from __future__ import annotations

import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import TypeVar

from roverlink.runtime.core.errors import SetupError

Self = TypeVar("Self", bound="HttpServer")


class HttpServer:
    """HTTP server that accepts requests on one thread, and answers each request on another thread.

    A context manager.
    """

    def __init__(
        self,
        address: str,
        port: int,
        what: str,
        handler: type[BaseHTTPRequestHandler],
        kind: type[ThreadingHTTPServer] = ThreadingHTTPServer,
    ) -> None:
        """Bind the port; for port 0, the system selects a free port.

        ``what`` says in errors what is served. ``handler`` answers the requests. Raises `SetupError` if the port is not
        available.
        """
        try:
            self._server = kind((address, port), handler)
        except (OSError, OverflowError) as error:
            raise SetupError(f"cannot serve the {what} on TCP port {port} of {address}: {error}") from error
        self.port: int = self._server.server_address[1]
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.1,), name=what, daemon=True)

    def __enter__(self: Self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()
