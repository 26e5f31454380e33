"""HTTP server of the page of the link. The page is read-only: the server answers nothing but GET."""

from __future__ import annotations

import json
from http import HTTPStatus
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

from roverlink.link_page.event_clients import CLIENTS
from roverlink.link_page.live_link import LiveLink
from roverlink.runtime.net.http_server import HttpServer
from roverlink.runtime.net.page_requests import (
    EVENT_STREAM,
    Answer,
    PageHandler,
    file_answer,
    is_this_computer,
    refusal,
)

_FILES = {"/": "index.html", "/page.css": "page.css", "/page.js": "page.js"}
_ALIVE_S = 5.0
_ALIVE = b"event: alive\ndata: {}\n\n"
"""Event that tells the browser that the connection works, if there is no other for some seconds."""
_OWN_SITES = ("same-origin", "none", None)


class LinkServer(HttpServer):
    """HTTP server of the page of the link. A context manager."""

    def __init__(self, address: str, port: int, live: LiveLink) -> None:
        """Bind the port; for port 0, the system selects a free port.

        Raises `SetupError` if the port is not available.
        """

        class Handler(_Handler):
            link = live

        super().__init__(address, port, "page", Handler)


class _Handler(PageHandler):
    link: LiveLink

    def do_GET(self) -> None:  # noqa: N802  # name of http.server
        try:
            address = urlsplit(self.path)
        except ValueError:  # such as http://[
            return self.send_answer(Answer(HTTPStatus.BAD_REQUEST, body=b"the path is not a URL\n"))
        if not is_this_computer(self.headers["Host"]):
            return self.send_answer(refusal("this is not the page's address"))
        if name := _FILES.get(address.path):
            return self.send_answer(file_answer(Path(__file__).with_name(name)))
        # Another site may link to the page, but not read its data or keep connections open.
        foreign = self.headers["Origin"] is not None and not self.is_own_origin()
        if foreign or self.headers["Sec-Fetch-Site"] not in _OWN_SITES:
            return self.send_answer(refusal("only the page itself may read its data"))
        if address.path == "/events":
            return self._follow()
        if address.path == "/history":
            query = parse_qs(address.query)
            found = self.link.history(query.get("row", [""])[0], query.get("field", [""])[0])
            return self.send_answer(Answer(HTTPStatus.OK, "application/json", json.dumps(found).encode()))
        return self.send_answer(Answer(HTTPStatus.NOT_FOUND, body=b"not found\n"))

    def _follow(self) -> None:
        """Send events until the browser leaves, does not read, or the page ends."""
        self.close_connection = True
        client = self.link.clients.add(self.connection)
        if client is None:
            why = f"{CLIENTS} browsers show this page already; close one of them\n".encode()
            return self.send_answer(Answer(HTTPStatus.SERVICE_UNAVAILABLE, body=why, headers={"Retry-After": "10"}))
        try:
            self.send_head(Answer(HTTPStatus.OK, EVENT_STREAM))
            self.wfile.write(self.link.snapshot())
            while (event := client.next_event(_ALIVE_S)) is not None:
                self.wfile.write(event or _ALIVE)
        finally:
            self.link.clients.remove(client)
        return None
