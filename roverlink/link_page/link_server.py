"""HTTP server of the page of the link. Without a token, the page is read-only: the server answers nothing but GET."""

from __future__ import annotations

import json
from collections.abc import Mapping
from http import HTTPStatus
from pathlib import Path
from typing import Any

from roverlink.link_page.event_clients import CLIENTS
from roverlink.link_page.live_page import LivePage
from roverlink.link_page.page_token import PageToken
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.net.http_server import HttpServer
from roverlink.runtime.net.page_requests import (
    EVENT_STREAM,
    Answer,
    PageHandler,
    bad_request,
    not_found,
    refusal,
)

_ALIVE_S = 2.0
_ALIVE = b"event: alive\ndata: {}\n\n"
"""Event that tells the browser that the connection works, if there is no other for some seconds."""
_OWN_SITES = ("same-origin", "none", None)
_DONE = Answer(HTTPStatus.NO_CONTENT)


class LinkServer(HttpServer):
    """HTTP server of the page of the link. A context manager."""

    def __init__(self, address: str, port: int, live: LivePage, page_token: PageToken | None = None) -> None:
        """Bind the port; for port 0, the system selects a free port. With ``page_token``, requests with it may act.

        Raises `SetupError` if the port is not available.
        """
        base = _Handler if page_token is None else _ActingHandler
        super().__init__(address, port, "page", type("Handler", (base,), {"page": live, "token": page_token}))


class _Handler(PageHandler):
    folder = Path(__file__).parent
    page: LivePage
    token: PageToken | None

    def get(self, path: str, query: Mapping[str, list[str]]) -> Answer | None:
        # Another site may link to the page, but not read its data or keep connections open.
        foreign = self.headers["Origin"] is not None and not self.is_own_origin()
        if foreign or self.headers["Sec-Fetch-Site"] not in _OWN_SITES:
            return refusal("only the page itself may read its data")
        bridge = query.get("bridge", [""])[0]
        if path == "/events":
            return self._follow(bridge)
        if path == "/history":
            return _json(self.page.history(bridge, query.get("row", [""])[0], query.get("field", [""])[0]))
        if path == "/parameters" and self.token is not None:
            return self.locked(self.token) or _json(self.page.parameters_now())
        return not_found()

    def locked(self, token: PageToken) -> Answer | None:
        """Return the answer that refuses the request; None if it has the token."""
        return token.refusal(self.headers["Authorization"], self.client_address[0])

    def _follow(self, bridge: str) -> Answer | None:
        """Send events until the browser leaves, does not read, or the page ends."""
        self.close_connection = True
        client = self.page.clients.add(self.connection, self.page.known(bridge))
        if client is None:
            why = f"{CLIENTS} browsers show this page already; close one of them\n".encode()
            return Answer(HTTPStatus.SERVICE_UNAVAILABLE, body=why, headers={"Retry-After": "10"})
        try:
            self.send_head(Answer(HTTPStatus.OK, EVENT_STREAM))
            self.wfile.write(self.page.snapshot(client.bridge, can_act=self.token is not None))
            while (event := client.next_event(_ALIVE_S)) is not None:
                self.wfile.write(event or _ALIVE)
        finally:
            self.page.clients.remove(client)
        return None


class _ActingHandler(_Handler):
    """Handler of a page with a token."""

    largest_body = 16_384

    def do_POST(self) -> None:  # noqa: N802  # name of http.server
        self.send_answer(self._post())

    def _post(self) -> Answer:
        if not self.is_own_action() or self.token is None:
            return refusal("this action needs the page itself")
        if refused := self.locked(self.token):
            return refused
        if self.body is None:
            return Answer(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, body=b"the request is too long\n")
        try:
            content = json.loads(self.body)
        except (ValueError, RecursionError):
            return bad_request("the request is not JSON")
        if self.path == "/acknowledge":
            return self._acknowledge(content)
        if self.path == "/parameters":
            return self._change(content)
        return not_found("unknown action")

    def _acknowledge(self, numbers: Any) -> Answer:
        if not isinstance(numbers, list) or not all(type(number) is int for number in numbers):
            return bad_request("the request is not a list of the numbers of alarms")
        self.page.acknowledge(numbers, self.client_address[0])
        return _DONE

    def _change(self, changes: Any) -> Answer:
        if not isinstance(changes, dict) or not changes:
            return bad_request("the request is not an object of parameters and values")
        try:
            self.page.change_parameters(changes)
        except SetupError as error:
            return Answer(HTTPStatus.CONFLICT, body=f"{error}\n".encode())
        return _DONE


def _json(content: Any) -> Answer:
    return Answer(HTTPStatus.OK, "application/json", json.dumps(content).encode())
