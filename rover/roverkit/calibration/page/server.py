"""HTTP server of the calibration page: shows the state of a `PageBackend`, and passes the user's clicks to it.

The server keeps no state and no queue. Each request has its own thread, so a slow browser delays only itself.

Requests are checked before they are answered, so that a page of another site cannot trigger actions here or show the
camera's image: the Host header must be an address or a name of this computer, and a POST must have the Origin header
of this page.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from http import HTTPStatus
from pathlib import Path
from typing import Any, Protocol

from roverlink.runtime.core.errors import RoverlinkError
from roverlink.runtime.net.http_server import HttpServer
from roverlink.runtime.net.page_requests import Answer, PageHandler, bad_request, not_found, refusal

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

    def image(self, after: int) -> tuple[int, bytes] | None:
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
    folder = Path(__file__).parent
    page: PageBackend

    def do_POST(self) -> None:  # noqa: N802  # name of http.server
        self.send_answer(
            self._post() if self.is_own_action() else refusal("this action needs the calibration page itself")
        )

    def get(self, path: str, query: Mapping[str, list[str]]) -> Answer:
        after = query.get("after", ["0"])[0]
        if not re.fullmatch(r"\d{1,18}", after):
            return bad_request("the query parameter 'after' must be a number")
        if path == "/state":
            return Answer(HTTPStatus.OK, "application/json", json.dumps(self.page.state(int(after))).encode())
        if path == "/picture":
            return self._image(int(after))
        if path == "/report" and (text := self.page.report()) is not None:
            return Answer(HTTPStatus.OK, "text/html", text.encode(), {"Content-Security-Policy": _REPORT_POLICY})
        match = _VIEW.fullmatch(path)
        if match and not match[2] and (jpeg := self.page.thumbnail(int(match[1]))) is not None:
            return Answer(HTTPStatus.OK, "image/jpeg", jpeg)
        return not_found()

    def _image(self, after: int) -> Answer:
        newest = self.page.image(after)
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
            return not_found("unknown action")
        try:
            self.page.act(action, view)
        except RoverlinkError as error:
            return Answer(HTTPStatus.CONFLICT, body=str(error).encode())
        return Answer(HTTPStatus.NO_CONTENT)
