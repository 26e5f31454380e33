"""Answers to the requests of pages that a browser shows: checks of the requests, and the headers of the answers.

A page of another site must not be able to read or trigger anything here, even if the name of that site resolves to this
computer (DNS rebinding). Therefore `is_this_computer` accepts only a Host header with an address or a name of this
computer, and `PageHandler.is_own_origin` compares the Origin header with it.
"""

from __future__ import annotations

import ipaddress
import re
import select
import socket
from collections.abc import Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from pathlib import Path
from typing import NamedTuple
from urllib.parse import parse_qs, urlsplit

COMPUTER = socket.gethostname()
"""Name of this computer."""
EVENT_STREAM = "text/event-stream"
"""Type of an answer without end: server-sent events."""
IMAGE_STREAM = "multipart/x-mixed-replace; boundary=image"
"""Type of an answer without end: images, each of which replaces the one before."""
_FILES = {"/": "index.html", "/page.css": "page.css", "/page.js": "page.js"}
_TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript"}
# Content Security Policy: nothing is loaded from elsewhere, and no other page may frame this one (clickjacking).
_PAGE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)


def is_loopback(address: str) -> bool:
    """Return true if only programs of this computer can reach an address."""
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return address == "localhost"


def is_this_computer(host: str | None) -> bool:
    """Return true if a Host header is an IP address or a name of this computer.

    Another site can make its own name resolve to this computer. The browser then sends that name, which is refused.
    """
    own = COMPUTER.lower()
    name = re.sub(r":\d+$", "", (host or "").lower())
    if name in ("localhost", own, f"{own}.local"):
        return True
    try:
        ipaddress.ip_address(name.removeprefix("[").removesuffix("]"))
    except ValueError:
        return False
    return True


class Answer(NamedTuple):
    """Answer to a request."""

    status: HTTPStatus
    type: str = "text/plain"
    body: bytes = b""
    headers: Mapping[str, str] = {}
    delay_s: float = 0.0
    """Time in seconds that the client has to wait for the answer."""


def refusal(why: str) -> Answer:
    """Return the answer that forbids a request, with the reason."""
    return Answer(
        HTTPStatus.FORBIDDEN, body=f"{why}; open it at http://{COMPUTER} or at an address of that computer\n".encode()
    )


def bad_request(why: str) -> Answer:
    """Return the answer to a request that is malformed, with the reason."""
    return Answer(HTTPStatus.BAD_REQUEST, body=f"{why}\n".encode())


def not_found(why: str = "not found") -> Answer:
    """Return the answer for a path that is not served."""
    return Answer(HTTPStatus.NOT_FOUND, body=f"{why}\n".encode())


def image_part(jpeg: bytes) -> bytes:
    """Return an image as a part of an `IMAGE_STREAM`."""
    return f"--image\r\nContent-Type: image/jpeg\r\nContent-Length: {len(jpeg)}\r\n\r\n".encode() + jpeg + b"\r\n"


def file_answer(file: Path) -> Answer:
    """Return the answer with a file of a page (HTML, CSS or JavaScript) that loads nothing from other sites."""
    return Answer(HTTPStatus.OK, _TYPES[file.suffix], file.read_bytes(), {"Content-Security-Policy": _PAGE_POLICY})


class PageHandler(BaseHTTPRequestHandler):
    """Base class of handlers that answer the requests of a page: its files, and by `get` its data."""

    protocol_version = "HTTP/1.1"
    folder: Path
    """Folder with index.html, page.css and page.js."""
    largest_body = 0
    """Largest body of a request that is read, in bytes."""
    body: bytes | None
    """Body of the request; None if it is longer than `largest_body`, or of unknown length."""

    def get(self, path: str, query: Mapping[str, list[str]]) -> Answer | None:
        """Return the answer to a GET request for anything but the page's files; None if it is sent already."""
        raise NotImplementedError

    def do_GET(self) -> None:
        """Answer a GET request, unless it names another computer; `http.server` calls this."""
        try:
            address = urlsplit(self.path)
        except ValueError:  # such as http://[
            return self.send_answer(bad_request("the path is not a URL"))
        if not is_this_computer(self.headers["Host"]):
            return self.send_answer(refusal("this is not the page's address"))
        if name := _FILES.get(address.path):
            return self.send_answer(file_answer(self.folder / name))
        answer = self.get(address.path, parse_qs(address.query))
        return None if answer is None else self.send_answer(answer)

    def parse_request(self) -> bool:
        """Read the request and its body; return false if there is nothing to answer. `http.server` calls this.

        The body is read here and not later, because the server ends connections whose requests are late.
        """
        if not super().parse_request():
            return False
        length = self.headers["Content-Length"] or "0"
        if (
            "Transfer-Encoding" in self.headers
            or not re.fullmatch(r"[0-9]{1,9}", length)
            or int(length) > self.largest_body
        ):
            self.body, self.close_connection = None, True  # what is not read must not be parsed as the next request
            return True
        self.body = self.rfile.read(int(length))
        return len(self.body) == int(length)

    def is_own_origin(self) -> bool:
        """Return true if a script of this page sent the request: its Origin header is the page's own address."""
        return bool(self.headers["Origin"] == f"http://{self.headers['Host']}")

    def is_own_action(self) -> bool:
        """Return true if a POST request may act: it names this computer, and a script of this page sent it."""
        return is_this_computer(self.headers["Host"]) and self.is_own_origin()

    def send_answer(self, answer: Answer) -> None:
        """Send an answer after its delay, unless the client leaves or sends more before."""
        self.send_response(answer.status)  # from here on, the server may end the connection for the sake of others
        if answer.delay_s and select.select([self.connection], [], [], answer.delay_s)[0]:
            self.close_connection = True
            return
        self._end_head(answer)
        self.wfile.write(answer.body)

    def send_head(self, answer: Answer) -> None:
        """Send status and headers of an answer; the length of the body is announced if it has one."""
        self.send_response(answer.status)
        self._end_head(answer)

    def _end_head(self, answer: Answer) -> None:
        for name, value in answer.headers.items():
            self.send_header(name, value)
        if answer.status != HTTPStatus.NO_CONTENT:
            charset = "; charset=utf-8" if answer.type.startswith("text/") else ""
            self.send_header("Content-Type", answer.type + charset)
            if answer.type not in (EVENT_STREAM, IMAGE_STREAM):
                self.send_header("Content-Length", str(len(answer.body)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Cross-Origin-Resource-Policy", "same-origin")
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
