"""HTTP server of the calibration page: shows the state of a `PageBackend`, and passes the user's clicks to it.

The server keeps no state and no queue. Each request has its own thread, so a slow browser delays only itself.

Requests are checked before they are answered. A page of another site must not be able to trigger actions here or to
show the camera's image, even if the name of that site resolves to this computer (DNS rebinding). Therefore the Host
header must be an address or a name of this computer, and a POST must have the Origin header of this page.
"""

from __future__ import annotations

import ipaddress
import json
import re
import socket
import sys
import threading
from collections.abc import Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, NamedTuple, Protocol
from urllib.parse import parse_qs, urlsplit

from roverlink.runtime.core.errors import RoverlinkError
from roverlink.runtime.net.http_server import HttpServer

_CONNECTIONS = 24
"""Most connections at a time; a browser opens six."""
_TIMEOUT_S = 20.0
"""Time in seconds after which an idle connection is closed; longer than a `PageBackend` waits for news."""
_EVERYWHERE = ("", "0.0.0.0")  # noqa: S104  # only on request (--page-address)
_FILES = {"/": "index.html", "/page.css": "page.css", "/page.js": "page.js"}
_TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript"}
# Content Security Policy: nothing is loaded from elsewhere, and no other page may frame this one (clickjacking).
_PAGE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_REPORT_POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; frame-ancestors 'none'"
_NAME = socket.gethostname()
_ADDRESSES = f"at http://{_NAME} or at an address of that computer"
_VIEW = re.compile(r"/views/(\d{1,9})(/drop)?")


class PageBackend(Protocol):
    """State and actions of the page, as the server needs them. All methods may be called from any thread."""

    def state(self, after: int) -> dict[str, Any]:
        """Return the state of the page with its number `version`; wait some seconds for a number greater than `after`.

        If nothing changes in this time, the same state is returned again. The server calls this for each request of the
        state.
        """

    def picture(self, after: int) -> tuple[int, bytes] | None:
        """Return number and JPEG of the newest image; wait some seconds for a number greater than `after`.

        Returns None if no such image comes.
        """

    def thumbnail(self, view: int) -> bytes | None:
        """Return the thumbnail of a view as JPEG, given the view's number; None if the view does not exist."""

    def report(self) -> str | None:
        """Return the calibration's report as HTML; None before the first calibration."""

    def act(self, action: str, view: int | None) -> None:
        """Carry out a click of the user: `take` a view, `drop` the view with the number `view`, `calibrate`, or `save`.

        Raises `RoverlinkError` if the action is not possible.
        """


class _Answer(NamedTuple):
    status: HTTPStatus
    type: str = "text/plain"
    body: bytes = b""
    headers: Mapping[str, str] = {}


class PageServer(HttpServer):
    """HTTP server of the calibration page. A context manager."""

    def __init__(self, address: str, port: int, backend: PageBackend) -> None:
        """Bind the port; for port 0, the system selects a free port.

        Raises `SetupError` if the port is not available.
        """

        class Handler(_Handler):
            page = backend

        super().__init__(address, port, "page", Handler, _Server)
        host = _NAME if address in _EVERYWHERE else address
        self.url = f"http://{host}:{self.port}/"


class _Server(ThreadingHTTPServer):
    """HTTP server with a limited number of connections.

    When the limit is reached, new connections are closed at once.
    """

    request_queue_size = _CONNECTIONS

    def __init__(self, *given: Any) -> None:
        self._free = threading.BoundedSemaphore(_CONNECTIONS)
        super().__init__(*given)

    def process_request(self, request: Any, client_address: Any) -> None:
        if self._free.acquire(blocking=False):
            super().process_request(request, client_address)
        else:
            self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._free.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        if not isinstance(sys.exc_info()[1], OSError):  # a browser that closed the connection is not an error
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    page: PageBackend
    protocol_version = "HTTP/1.1"
    timeout = _TIMEOUT_S

    def do_GET(self) -> None:
        self._send(self._get() if _is_ours(self.headers["Host"]) else _forbidden(f"open this page {_ADDRESSES}"))

    def do_POST(self) -> None:
        self.close_connection = True  # the body is not read; it must not be parsed as the next request
        if not _is_ours(self.headers["Host"]) or self.headers["Origin"] != f"http://{self.headers['Host']}":
            return self._send(_forbidden(f"only this page may do that; it is {_ADDRESSES}"))
        return self._send(self._post())

    def _get(self) -> _Answer:
        address = urlsplit(self.path)
        after = parse_qs(address.query).get("after", ["0"])[0]
        if not re.fullmatch(r"\d{1,18}", after):
            return _Answer(HTTPStatus.BAD_REQUEST, body=b"the query parameter 'after' must be a number\n")
        if name := _FILES.get(address.path):
            file = Path(__file__).with_name(name)
            return _Answer(
                HTTPStatus.OK, _TYPES[file.suffix], file.read_bytes(), {"Content-Security-Policy": _PAGE_POLICY}
            )
        if address.path == "/state":
            return _Answer(HTTPStatus.OK, "application/json", json.dumps(self.page.state(int(after))).encode())
        if address.path == "/picture":
            return self._picture(int(after))
        if address.path == "/report" and (text := self.page.report()) is not None:
            return _Answer(HTTPStatus.OK, _TYPES[".html"], text.encode(), {"Content-Security-Policy": _REPORT_POLICY})
        match = _VIEW.fullmatch(address.path)
        if match and not match[2] and (jpeg := self.page.thumbnail(int(match[1]))) is not None:
            return _Answer(HTTPStatus.OK, "image/jpeg", jpeg)
        return _Answer(HTTPStatus.NOT_FOUND, body=b"not found\n")

    def _picture(self, after: int) -> _Answer:
        newest = self.page.picture(after)
        if newest is None:
            return _Answer(HTTPStatus.NO_CONTENT)
        number, jpeg = newest
        return _Answer(HTTPStatus.OK, "image/jpeg", jpeg, {"Picture-Number": str(number)})

    def _post(self) -> _Answer:
        match = _VIEW.fullmatch(self.path)
        if match and match[2]:
            action, view = "drop", int(match[1])
        elif self.path in ("/take", "/calibrate", "/save"):
            action, view = self.path[1:], None
        else:
            return _Answer(HTTPStatus.NOT_FOUND, body=b"unknown action\n")
        try:
            self.page.act(action, view)
        except RoverlinkError as error:
            return _Answer(HTTPStatus.CONFLICT, body=str(error).encode())
        return _Answer(HTTPStatus.NO_CONTENT)

    def _send(self, answer: _Answer) -> None:
        self.send_response(answer.status)
        for name, value in answer.headers.items():
            self.send_header(name, value)
        if answer.status != HTTPStatus.NO_CONTENT:
            charset = "; charset=utf-8" if answer.type.startswith("text/") else ""
            self.send_header("Content-Type", answer.type + charset)
            self.send_header("Content-Length", str(len(answer.body)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Cross-Origin-Resource-Policy", "same-origin")
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(answer.body)

    def log_message(self, *_: object) -> None:
        """Log nothing. The base class would log every request, and the page sends several a second."""


def _is_ours(host: str | None) -> bool:
    """Return true if a Host header is an IP address or a name of this computer.

    Another site can make its own name resolve to this computer. The browser then sends that name, which is refused.
    """
    own = _NAME.lower()
    name = re.sub(r":\d+$", "", (host or "").lower())
    if name in ("localhost", own, f"{own}.local"):
        return True
    try:
        ipaddress.ip_address(name.removeprefix("[").removesuffix("]"))
    except ValueError:
        return False
    return True


def _forbidden(why: str) -> _Answer:
    return _Answer(HTTPStatus.FORBIDDEN, body=f"{why}\n".encode())
