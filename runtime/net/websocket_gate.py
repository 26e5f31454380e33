"""Gate before a WebSocket server that cannot check who connects: it reads the headers, and then passes on all bytes.

A script of any site may connect to any WebSocket server that its browser reaches; only the server can refuse it. The
server behind the gate listens on an address that no script can guess, see `hidden_address`.
"""

from __future__ import annotations

import secrets
import socket
import sys
import threading
from collections.abc import Callable, Collection
from http.server import BaseHTTPRequestHandler
from urllib.parse import urlsplit

from roverlink.runtime.net.http_server import HttpServer
from roverlink.runtime.net.page_requests import is_this_computer, refusal

_BLOCK = 65_536


def hidden_address() -> str:
    """Return a random address that only programs of this computer reach.

    On Linux, all of 127.0.0.0/8 is this computer, so that a script would have to try 2^24 addresses and all ports.
    """
    if sys.platform != "linux":
        return "127.0.0.1"
    return f"127.{1 + secrets.randbelow(254)}.{secrets.randbelow(256)}.{1 + secrets.randbelow(254)}"


class WebSocketGate(HttpServer):
    """Server that passes on the connections of allowed clients. A context manager.

    A client is allowed if its header Host names this computer, and if its header Origin is that of a page of the same
    host or one of `origins`; programs that are no browsers send none.
    """

    def __init__(self, address: str, port: int, what: str, server: tuple[str, int], origins: Collection[str]) -> None:
        """Bind the port; for port 0, the system selects a free port. Connections are passed on to ``server``.

        Raises `SetupError` if the port is not available.
        """
        super().__init__(address, port, what, type("Handler", (_Handler,), {"behind": server, "origins": origins}))


class _Handler(BaseHTTPRequestHandler):
    behind: tuple[str, int]
    origins: Collection[str]

    def do_GET(self) -> None:
        if not self._is_allowed():
            answer = refusal("this is not the server's address, or a page of another site has asked")
            self.send_response(answer.status)
            self.end_headers()
            self.wfile.write(answer.body)
            return
        head = "".join(f"{name}: {value}\r\n" for name, value in self.headers.items())
        with socket.create_connection(self.behind) as server:
            self.connection.settimeout(None)  # a viewer may be silent
            server.sendall(f"{self.requestline}\r\n{head}\r\n".encode("latin-1"))
            back = threading.Thread(target=_pass_on, args=(server.recv, self.connection, server), daemon=True)
            back.start()
            _pass_on(self.rfile.read1, server, self.connection)
            back.join()

    def _is_allowed(self) -> bool:
        host, origin = self.headers["Host"], self.headers["Origin"]
        if not is_this_computer(host) or origin in self.origins:
            return is_this_computer(host)
        return origin is None or urlsplit(origin).hostname == urlsplit(f"//{host}").hostname


def _pass_on(receive: Callable[[int], bytes], target: socket.socket, source: socket.socket) -> None:
    """Pass on bytes until one of the ends closes its connection; then end both."""
    try:
        while data := receive(_BLOCK):
            target.sendall(data)
    except OSError:  # an end is gone
        pass
    finally:
        for sock in (target, source):
            try:
                sock.shutdown(socket.SHUT_RDWR)
            except OSError:  # the other direction was faster
                continue
