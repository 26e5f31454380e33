"""Answers to the requests of pages that a browser shows: checks of the requests, and the headers of the answers.

A page of another site must not be able to read or trigger anything here, even if the name of that site resolves to this
computer (DNS rebinding). Therefore `is_this_computer` accepts only a Host header with an address or a name of this
computer, and `PageHandler.is_own_origin` compares the Origin header with it.
"""

from __future__ import annotations

import ipaddress
import re
import socket
from collections.abc import Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from pathlib import Path
from typing import NamedTuple

COMPUTER = socket.gethostname()
"""Name of this computer."""
EVENT_STREAM = "text/event-stream"
"""Type of an answer without end: server-sent events."""
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


def refusal(why: str) -> Answer:
    """Return the answer that forbids a request, with the reason."""
    return Answer(
        HTTPStatus.FORBIDDEN, body=f"{why}; open it at http://{COMPUTER} or at an address of that computer\n".encode()
    )


def file_answer(file: Path) -> Answer:
    """Return the answer with a file of a page (HTML, CSS or JavaScript) that loads nothing from other sites."""
    return Answer(HTTPStatus.OK, _TYPES[file.suffix], file.read_bytes(), {"Content-Security-Policy": _PAGE_POLICY})


class PageHandler(BaseHTTPRequestHandler):
    """Base class of handlers that answer the requests of a page."""

    protocol_version = "HTTP/1.1"

    def is_own_origin(self) -> bool:
        """Return true if a script of this page sent the request: its Origin header is the page's own address."""
        return bool(self.headers["Origin"] == f"http://{self.headers['Host']}")

    def send_answer(self, answer: Answer) -> None:
        """Send an answer."""
        self.send_head(answer)
        self.wfile.write(answer.body)

    def send_head(self, answer: Answer) -> None:
        """Send status and headers of an answer; the length of the body is announced if it has one."""
        self.send_response(answer.status)
        for name, value in answer.headers.items():
            self.send_header(name, value)
        if answer.status != HTTPStatus.NO_CONTENT:
            charset = "; charset=utf-8" if answer.type.startswith("text/") else ""
            self.send_header("Content-Type", answer.type + charset)
            if answer.type != EVENT_STREAM:
                self.send_header("Content-Length", str(len(answer.body)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Cross-Origin-Resource-Policy", "same-origin")
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
