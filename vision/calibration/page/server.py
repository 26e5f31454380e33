"""The HTTP server of the page: it shows what a `Desk` has, and hands it the clicks.

It holds nothing of its own and queues nothing. Every request waits in a thread of its own, so a browser that reads
slowly keeps nobody waiting but itself. Who may ask is checked before anything is answered: a page of another site must
neither click here nor show the camera, even where its name was made to mean this computer (DNS rebinding).
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
"""At a time; a browser opens six."""
_TIMEOUT_S = 20.0
"""For which a connection may stand still; longer than a `Desk` waits for news."""
_EVERYWHERE = ("", "0.0.0.0")  # noqa: S104  # if somebody asks for it
_FILES = {"/": "index.html", "/page.css": "page.css", "/page.js": "page.js"}
_TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript"}
_PAGE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_REPORT_POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; frame-ancestors 'none'"
_NAME = socket.gethostname()
_ADDRESSES = f"at http://{_NAME}, and at the addresses of that computer"
_VIEW = re.compile(r"/views/(\d{1,9})(/drop)?")


class Desk(Protocol):
    """What the page shows and does. Every method may be called from any thread."""

    def state(self, after: int) -> dict[str, Any]:
        """All that the page shows, with its `version`: at once where that is above `after`, else when it changes.

        Where nothing changes for some seconds, it is the same again.
        """

    def picture(self, after: int) -> tuple[int, bytes] | None:
        """The newest picture's number, above `after`, and its JPEG; None where none comes for some seconds."""

    def thumbnail(self, view: int) -> bytes | None:
        """A view's picture as a small JPEG; None where there is no such view."""

    def report(self) -> str | None:
        """The report of the calibration, as HTML; None before there is one."""

    def act(self, action: str, view: int | None) -> None:
        """Do `take`, `drop` (of a view), `calibrate` or `save`. Raises `RoverlinkError` where that cannot be done."""


class _Answer(NamedTuple):
    status: HTTPStatus
    type: str = "text/plain"
    body: bytes = b""
    headers: Mapping[str, str] = {}


class PageServer(HttpServer):
    """Serves the page from a desk. A context manager."""

    def __init__(self, address: str, port: int, desk: Desk) -> None:
        """Port 0 takes a free one. Raises `SetupError` where the port cannot be had."""

        class Handler(_Handler):
            shown = desk

        super().__init__(address, port, "page", Handler, _Server)
        host = _NAME if address in _EVERYWHERE else address
        self.url = f"http://{host}:{self.port}/"


class _Server(ThreadingHTTPServer):
    """One that takes so many connections and no more; what comes beyond is closed."""

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
        if not isinstance(sys.exc_info()[1], OSError):  # a browser that has gone is no error
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    shown: Desk
    protocol_version = "HTTP/1.1"
    timeout = _TIMEOUT_S

    def do_GET(self) -> None:
        self._send(self._get() if _is_ours(self.headers["Host"]) else _forbidden(f"this page is {_ADDRESSES}"))

    def do_POST(self) -> None:
        self.close_connection = True  # no body is read; should one follow, it must not be taken for a request
        if not _is_ours(self.headers["Host"]) or self.headers["Origin"] != f"http://{self.headers['Host']}":
            return self._send(_forbidden(f"only the page itself may do this, and it is {_ADDRESSES}"))
        return self._send(self._post())

    def _get(self) -> _Answer:
        address = urlsplit(self.path)
        after = parse_qs(address.query).get("after", ["0"])[0]
        if not re.fullmatch(r"\d{1,18}", after):
            return _Answer(HTTPStatus.BAD_REQUEST, body=b"after is a number\n")
        if name := _FILES.get(address.path):
            file = Path(__file__).with_name(name)
            return _Answer(
                HTTPStatus.OK, _TYPES[file.suffix], file.read_bytes(), {"Content-Security-Policy": _PAGE_POLICY}
            )
        if address.path == "/state":
            return _Answer(HTTPStatus.OK, "application/json", json.dumps(self.shown.state(int(after))).encode())
        if address.path == "/picture":
            return self._picture(int(after))
        if address.path == "/report" and (text := self.shown.report()) is not None:
            return _Answer(HTTPStatus.OK, _TYPES[".html"], text.encode(), {"Content-Security-Policy": _REPORT_POLICY})
        match = _VIEW.fullmatch(address.path)
        if match and not match[2] and (jpeg := self.shown.thumbnail(int(match[1]))) is not None:
            return _Answer(HTTPStatus.OK, "image/jpeg", jpeg)
        return _Answer(HTTPStatus.NOT_FOUND, body=b"there is nothing here\n")

    def _picture(self, after: int) -> _Answer:
        newest = self.shown.picture(after)
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
            return _Answer(HTTPStatus.NOT_FOUND, body=b"there is no such thing to do\n")
        try:
            self.shown.act(action, view)
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
        """Requests are no news."""


def _is_ours(host: str | None) -> bool:
    """Whether a request's Host is an address or a name of this computer: no other site's name can be one."""
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
