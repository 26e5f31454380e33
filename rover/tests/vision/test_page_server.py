"""Who may look at the page, who may click, and that nobody keeps the others waiting."""

from __future__ import annotations

import http.client
import re
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from typing import Any

import pytest
from polling import PATIENCE_S, wait_until
from roverkit.calibration.page.server import PageServer

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.net.http_server import BoundedServer


class _Desk:
    """One view with the number 1, a large picture, and a list of what was clicked; a busy one has no state for now."""

    def __init__(self, busy: bool = False) -> None:
        self.done: list[tuple[str, int | None]] = []
        self.asked: list[int] = []
        self.free = threading.Event()
        if not busy:
            self.free.set()

    def state(self, after: int) -> dict[str, Any]:
        self.asked.append(after)
        self.free.wait(PATIENCE_S)
        return {"version": after + 1}

    def image(self, after: int) -> tuple[int, bytes] | None:
        return (5, bytes(50_000_000)) if after < 5 else None

    def thumbnail(self, view: int) -> bytes | None:
        return b"\xff\xd8" if view == 1 else None

    def report(self) -> str | None:
        return None

    def act(self, action: str, view: int | None) -> None:
        if action == "save":
            raise SetupError("there is nothing to save yet")
        self.done.append((action, view))


@pytest.fixture(scope="module")
def served() -> Iterator[tuple[_Desk, int]]:
    desk = _Desk()
    with PageServer("127.0.0.1", 0, desk) as server:
        yield desk, server.port


@pytest.fixture
def desk(served: tuple[_Desk, int]) -> _Desk:
    """The desk behind the server, with nothing clicked yet."""
    served[0].done.clear()
    return served[0]


@pytest.fixture
def port(served: tuple[_Desk, int]) -> int:
    return served[1]


def ask(port: int, method: str, path: str, **headers: str) -> tuple[int, bytes]:
    """The status and the body of an answer; `Host` is the server's unless it is given."""
    with closing(http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)) as connection:
        connection.request(method, path, headers=headers)
        answer = connection.getresponse()
        return answer.status, answer.read()


def post(port: int, path: str) -> tuple[int, bytes]:
    """The answer to a click on the page itself."""
    return ask(port, "POST", path, Origin=f"http://127.0.0.1:{port}")


@contextmanager
def sent(port: int, request: str) -> Iterator[socket.socket]:
    """A connection on which a request was sent."""
    with socket.create_connection(("127.0.0.1", port), PATIENCE_S) as sock:
        sock.sendall(f"{request} HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n".encode())
        yield sock


def test_the_page_and_what_it_needs_are_served(port: int) -> None:
    """Page, style and program name no other site; the browser is told to load nothing from there."""
    for path in ("/", "/page.css", "/page.js"):
        status, body = ask(port, "GET", path)
        assert status == 200
        assert not re.search(rb"""https?:|["'(]//|@import""", body)
    with closing(http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)) as connection:
        connection.request("GET", "/")
        policy = connection.getresponse().headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "frame-ancestors 'none'" in policy


@pytest.mark.parametrize("host", ["evil.example:80", "localhost.evil.example", "127.0.0.1.evil", ""])
def test_another_name_for_this_computer_is_refused(port: int, desk: _Desk, host: str) -> None:
    """A site that lets its own name mean this computer sees nothing; addresses and this computer's names are taken."""
    for own in ("localhost:8000", "[::1]:8000", "192.168.0.7", f"{socket.gethostname()}.local:80"):
        assert ask(port, "GET", "/state", Host=own)[0] == 200
    assert ask(port, "GET", "/state", Host=host)[0] == 403
    assert ask(port, "POST", "/take", Host=host, Origin=f"http://{host}")[0] == 403
    assert desk.done == []


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://127.0.0.1:{}", "http://127.0.0.1:1", None])
def test_a_click_on_another_site_does_nothing(port: int, desk: _Desk, origin: str | None) -> None:
    """Only the page itself may post: neither another site, nor another port, nor one who does not say who asks."""
    headers = {} if origin is None else {"Origin": origin.format(port)}
    assert ask(port, "POST", "/take", **headers)[0] == 403
    assert desk.done == []


def test_clicks_reach_the_desk(port: int, desk: _Desk) -> None:
    """Each button does its thing, once; the body of the answer says why it cannot. A post elsewhere is no click."""
    for path in ("/take", "/views/1/drop", "/calibrate"):
        assert post(port, path)[0] == 204
    assert post(port, "/save") == (409, b"there is nothing to save yet")
    for path in ("/", "/views/1", "/views/x/drop", "/shutdown"):
        assert post(port, path)[0] == 404
    assert desk.done == [("take", None), ("drop", 1), ("calibrate", None)]


@pytest.mark.parametrize(
    ("path", "status"),
    [
        ("/views/1", 200),
        ("/views/2", 404),
        ("/report", 404),
        ("/../server.py", 404),
        ("/state?after=many", 400),
        ("/picture?after=5", 204),
    ],
)
def test_paths(port: int, path: str, status: int) -> None:
    """What is there is served, nothing else is."""
    assert ask(port, "GET", path)[0] == status


def test_connections_are_limited() -> None:
    """If answers are being made on all of them, one more is closed; there is room again when they are done."""
    desk = _Desk(busy=True)
    with PageServer("127.0.0.1", 0, desk) as server, ExitStack() as held:
        for _ in range(BoundedServer.connections):
            held.enter_context(sent(server.port, "GET /state"))
        wait_until(lambda: len(desk.asked) == BoundedServer.connections, "all requests")
        with pytest.raises(OSError):  # noqa: PT011  # closed, in one way or another
            ask(server.port, "GET", "/state")
        desk.free.set()

        def has_room() -> bool:
            with suppress(OSError, http.client.HTTPException):  # still closed
                return ask(server.port, "GET", "/state")[0] == 200
            return False

        wait_until(has_room, "room for another connection")


def test_a_server_for_everybody_has_an_address_that_others_can_open() -> None:
    """It is on all addresses, and its URL has one of them, or the computer's name; it ends though a browser waits."""
    with PageServer("0.0.0.0", 0, _Desk()) as server:  # noqa: S104  # what is tested
        assert "0.0.0.0" not in server.url  # noqa: S104  # what is tested
        assert ask(server.port, "GET", "/state", Host=server.url.split("/")[2])[0] == 200
        sock = socket.create_connection(("127.0.0.1", server.port))
        begin = time.monotonic()
    assert time.monotonic() - begin < 18  # a silent browser is cut off only after 20 s
    sock.close()
