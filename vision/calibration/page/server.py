"""HTTP server of the calibration page: shows the state of a `PageBackend`, and passes the user's clicks to it.

The server keeps no state and no queue. Each request has its own thread, so a slow browser delays only itself.

Requests are checked before they are answered, so that a page of another site cannot trigger actions here or show the
camera's image: the Host header must be an address or a name of this computer, and a POST must have the Origin header
of this page.
"""

from __future__ import annotations

import json
import re
from http import HTTPStatus
from pathlib import Path
from typing import Any, Protocol
from urllib.parse import parse_qs, urlsplit

from roverlink.runtime.core.errors import RoverlinkError
from roverlink.runtime.net.http_server import HttpServer
from roverlink.runtime.net.page_requests import Answer, PageHandler, file_answer, is_this_computer, refusal

_FILES = {"/": "index.html", "/page.css": "page.css", "/page.js": "page.js"}
_REPORT_POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; frame-ancestors 'none'"
_VIEW = re.compile(r"/views/(\d{1,9})(/drop)?")


class PageBackend(Protocol):
    """Interface between the HTTP server and the calibration: the state of the page, and the actions of its buttons.

    All methods may be called from any thread.
    """

    def state(self, after: int) -> dict[str, Any]:
        """Return the state of the page with its number `version`; wait some seconds for a number greater than `after`.

        The state consists of JSON values. If nothing changes in this time, the same state is returned again. The server
        calls this for each request of the state.
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


class PageServer(HttpServer):
    """HTTP server of the calibration page. A context manager."""

    def __init__(self, address: str, port: int, backend: PageBackend) -> None:
        """Bind the port; for port 0, the system selects a free port.

        Raises `SetupError` if the port is not available.
        """

        class Handler(_Handler):
            page = backend

        super().__init__(address, port, "page", Handler)


class _Handler(PageHandler):
    page: PageBackend

    def do_GET(self) -> None:  # noqa: N802  # name of http.server
        self.send_answer(
            self._get() if is_this_computer(self.headers["Host"]) else refusal("this is not the page's address")
        )

    def do_POST(self) -> None:  # noqa: N802  # name of http.server
        self.close_connection = True  # the body is not read; it must not be parsed as the next request
        if not is_this_computer(self.headers["Host"]) or not self.is_own_origin():
            return self.send_answer(refusal("this action needs the calibration page itself"))
        return self.send_answer(self._post())

    def _get(self) -> Answer:
        try:
            address = urlsplit(self.path)
        except ValueError:  # such as http://[
            return Answer(HTTPStatus.BAD_REQUEST, body=b"the path is not a URL\n")
        after = parse_qs(address.query).get("after", ["0"])[0]
        if not re.fullmatch(r"\d{1,18}", after):
            return Answer(HTTPStatus.BAD_REQUEST, body=b"the query parameter 'after' must be a number\n")
        if name := _FILES.get(address.path):
            return file_answer(Path(__file__).with_name(name))
        if address.path == "/state":
            return Answer(HTTPStatus.OK, "application/json", json.dumps(self.page.state(int(after))).encode())
        if address.path == "/picture":
            return self._picture(int(after))
        if address.path == "/report" and (text := self.page.report()) is not None:
            return Answer(HTTPStatus.OK, "text/html", text.encode(), {"Content-Security-Policy": _REPORT_POLICY})
        match = _VIEW.fullmatch(address.path)
        if match and not match[2] and (jpeg := self.page.thumbnail(int(match[1]))) is not None:
            return Answer(HTTPStatus.OK, "image/jpeg", jpeg)
        return Answer(HTTPStatus.NOT_FOUND, body=b"not found\n")

    def _picture(self, after: int) -> Answer:
        newest = self.page.picture(after)
        if newest is None:
            return Answer(HTTPStatus.NO_CONTENT)
        number, jpeg = newest
        return Answer(HTTPStatus.OK, "image/jpeg", jpeg, {"Picture-Number": str(number)})

    def _post(self) -> Answer:
        match = _VIEW.fullmatch(self.path)
        if match and match[2]:
            action, view = "drop", int(match[1])
        elif self.path in ("/take", "/calibrate", "/save"):
            action, view = self.path[1:], None
        else:
            return Answer(HTTPStatus.NOT_FOUND, body=b"unknown action\n")
        try:
            self.page.act(action, view)
        except RoverlinkError as error:
            return Answer(HTTPStatus.CONFLICT, body=str(error).encode())
        return Answer(HTTPStatus.NO_CONTENT)
