"""Who may look at the page, who may click, and that nobody keeps the others waiting."""

from __future__ import annotations

import http.client
import re
import socket
import struct
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from typing import Any

import pytest
from polling import PATIENCE_S, wait_until

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.net import http_server
from roverlink.runtime.net.http_server import BoundedServer
from roverlink.vision.calibration.page.server import PageServer


class _DeskOfOneView:
    """One view with the number 1, a large picture, and a list of what was clicked."""

    def __init__(self) -> None:
        self.done: list[tuple[str, int | None]] = []

    def state(self, after: int) -> dict[str, Any]:
        return {"version": after + 1}

    def picture(self, after: int) -> tuple[int, bytes] | None:
        return (5, bytes(50_000_000)) if after < 5 else None

    def thumbnail(self, view: int) -> bytes | None:
        return b"\xff\xd8" if view == 1 else None

    def report(self) -> str | None:
        return None

    def act(self, action: str, view: int | None) -> None:
        if action == "save":
            raise SetupError("there is nothing to save yet")
        self.done.append((action, view))


class _BusyDesk(_DeskOfOneView):
    """A desk whose state takes until it is free."""

    def __init__(self) -> None:
        super().__init__()
        self.asked, self.free, self._lock = 0, threading.Event(), threading.Lock()

    def state(self, after: int) -> dict[str, Any]:
        with self._lock:
            self.asked += 1
        self.free.wait(PATIENCE_S)
        return super().state(after)


def port_of(server: PageServer) -> int:
    return int(server.url.rstrip("/").rsplit(":", 1)[1])


@pytest.fixture(scope="module")
def served() -> Iterator[tuple[_DeskOfOneView, int]]:
    desk = _DeskOfOneView()
    with PageServer("127.0.0.1", 0, desk) as server:
        yield desk, port_of(server)


@pytest.fixture
def desk(served: tuple[_DeskOfOneView, int]) -> _DeskOfOneView:
    """The desk behind the server, with nothing clicked yet."""
    served[0].done.clear()
    return served[0]


@pytest.fixture
def port(served: tuple[_DeskOfOneView, int]) -> int:
    return served[1]


def ask(port: int, method: str, path: str, **headers: str) -> tuple[int, bytes]:
    """The status and the body of an answer; `Host` is the server's unless it is given."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
    try:
        connection.request(method, path, headers=headers)
        answer = connection.getresponse()
        return answer.status, answer.read()
    finally:
        connection.close()


def own(port: int) -> dict[str, str]:
    return {"Origin": f"http://127.0.0.1:{port}"}


def test_the_page_and_what_it_needs_are_served(port: int) -> None:
    """The page, its style and its program come from here, and name no other site."""
    for path in ("/", "/page.css", "/page.js"):
        status, body = ask(port, "GET", path)
        assert status == 200
        assert not re.search(rb"""https?:|["'(]//|@import""", body)


def test_what_the_page_may_load_is_said_with_it(port: int) -> None:
    """The browser is told to load nothing from elsewhere, and to show the page in no frame of another."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
    connection.request("GET", "/")
    policy = connection.getresponse().headers["Content-Security-Policy"]
    connection.close()
    assert "default-src 'none'" in policy
    assert "frame-ancestors 'none'" in policy


@pytest.mark.parametrize("host", ["evil.example", "evil.example:80", "localhost.evil.example", "127.0.0.1.evil", ""])
def test_another_name_for_this_computer_is_refused(port: int, desk: _DeskOfOneView, host: str) -> None:
    """A site that lets its own name mean this computer sees nothing and does nothing."""
    assert ask(port, "GET", "/state", Host=host)[0] == 403
    assert ask(port, "POST", "/take", Host=host, Origin=f"http://{host}")[0] == 403
    assert desk.done == []


@pytest.mark.parametrize("host", ["localhost:8000", "[::1]:8000", "192.168.0.7", "{}", "{}.local:80"])
def test_addresses_and_names_of_this_computer_are_taken(port: int, host: str) -> None:
    """An address, `localhost` through a tunnel with any port, and the computer's own name."""
    assert ask(port, "GET", "/state", Host=host.format(socket.gethostname()))[0] == 200


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://127.0.0.1:{}", "http://127.0.0.1:1", None])
def test_a_click_on_another_site_does_nothing(port: int, desk: _DeskOfOneView, origin: str | None) -> None:
    """Only the page itself may post: neither another site, nor another port, nor one who does not say who asks."""
    headers = {} if origin is None else {"Origin": origin.format(port)}
    assert ask(port, "POST", "/take", **headers)[0] == 403
    assert desk.done == []


def test_clicks_reach_the_desk(port: int, desk: _DeskOfOneView) -> None:
    """Each button does its thing, once."""
    for path in ("/take", "/views/1/drop", "/calibrate"):
        assert ask(port, "POST", path, **own(port))[0] == 204
    assert desk.done == [("take", None), ("drop", 1), ("calibrate", None)]


def test_what_cannot_be_done_says_why(port: int) -> None:
    """The reason is the body of the answer."""
    assert ask(port, "POST", "/save", **own(port)) == (409, b"there is nothing to save yet")


@pytest.mark.parametrize(
    ("path", "status"),
    [
        ("/views/1", 200),
        ("/views/2", 404),
        ("/report", 404),
        ("/server.py", 404),
        ("/../server.py", 404),
        ("/views/../server.py", 404),
        ("/state?after=many", 400),
        ("/state?after=1e9", 400),
        ("/picture?after=5", 204),
    ],
)
def test_paths(port: int, path: str, status: int) -> None:
    """What is there is served, nothing else is."""
    assert ask(port, "GET", path)[0] == status


def test_a_path_that_is_no_url_is_refused(port: int, capfd: pytest.CaptureFixture[str]) -> None:
    """With status 400, and without a traceback."""
    with socket.create_connection(("127.0.0.1", port), PATIENCE_S) as sock:
        sock.sendall(f"GET http://[ HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n".encode())
        assert sock.recv(4096).startswith(b"HTTP/1.1 400")
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("path", ["/", "/views/1", "/views/x/drop", "/shutdown"])
def test_there_is_nothing_else_to_do(port: int, desk: _DeskOfOneView, path: str) -> None:
    """A post elsewhere is no click."""
    assert ask(port, "POST", path, **own(port))[0] == 404
    assert desk.done == []


def test_a_body_is_not_taken_for_a_request(port: int, desk: _DeskOfOneView) -> None:
    """What follows a post on its connection is not read."""
    hidden = f"POST /calibrate HTTP/1.1\r\nHost: localhost:{port}\r\nOrigin: http://localhost:{port}\r\n\r\n"
    outer = f"POST /take HTTP/1.1\r\nHost: localhost:{port}\r\nOrigin: http://localhost:{port}\r\n"
    with socket.create_connection(("127.0.0.1", port), PATIENCE_S) as sock:
        sock.sendall(f"{outer}Content-Length: {len(hidden)}\r\n\r\n{hidden}".encode())
        while sock.recv(65536):
            pass
    assert desk.done == [("take", None)]


def test_a_browser_that_does_not_read_keeps_nobody_waiting(port: int) -> None:
    """Fifty megabytes wait in vain; others are served at once."""
    with socket.create_connection(("127.0.0.1", port), PATIENCE_S) as sock:
        sock.sendall(f"GET /picture HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n".encode())
        assert sock.recv(1)
        assert ask(port, "GET", "/state")[0] == 200


def test_slow_browsers_stop_nobody(port: int, capfd: pytest.CaptureFixture[str]) -> None:
    """Not 300 that have sent half a request: threads stay few, and nothing is said about them on standard error."""
    threads = threading.active_count()
    with ExitStack() as held:
        for _ in range(300):
            sock = held.enter_context(socket.create_connection(("127.0.0.1", port), PATIENCE_S))
            sock.sendall(b"GET /sta")
        for _ in range(5):
            assert ask(port, "GET", "/state")[0] == 200
            assert threading.active_count() <= threads + BoundedServer.connections
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # closed with a reset
    assert ask(port, "GET", "/state")[0] == 200
    assert capfd.readouterr().err == ""


def test_half_a_request_ends(port: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """A client that sends a byte now and then, and one that sends nothing after its answer, are cut off."""
    monkeypatch.setattr(http_server, "_REQUEST_S", 0.3)
    with socket.create_connection(("127.0.0.1", port), PATIENCE_S) as sock, suppress(OSError):
        sock.settimeout(0.02)
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            sock.sendall(b"x")
            with suppress(TimeoutError):
                if not sock.recv(1):
                    break
    assert time.monotonic() < deadline
    with socket.create_connection(("127.0.0.1", port), PATIENCE_S) as sock:
        sock.sendall(f"GET /state HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n".encode())
        assert sock.recv(4096).startswith(b"HTTP/1.1 200")
        while sock.recv(4096):
            pass


def test_connections_are_limited() -> None:
    """If answers are being made on all of them, one more is closed; there is room again when they are done."""
    desk = _BusyDesk()
    with PageServer("127.0.0.1", 0, desk) as server, ExitStack() as held:
        port = port_of(server)
        for _ in range(BoundedServer.connections):
            sock = held.enter_context(socket.create_connection(("127.0.0.1", port), PATIENCE_S))
            sock.sendall(f"GET /state HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n".encode())
        wait_until(lambda: desk.asked == BoundedServer.connections, "all requests")
        with pytest.raises(OSError):  # noqa: PT011  # closed, in one way or another
            ask(port, "GET", "/state")
        desk.free.set()

        def has_room() -> bool:
            with suppress(OSError, http.client.HTTPException):  # still closed
                return ask(port, "GET", "/state")[0] == 200
            return False

        wait_until(has_room, "room for another connection")


def test_a_port_that_is_taken_is_named(port: int) -> None:
    """It says which, and why."""
    with pytest.raises(SetupError, match=f"TCP port {port} of 127.0.0.1"):
        PageServer("127.0.0.1", port, _DeskOfOneView())


def test_where_everybody_may_look_the_address_is_one_that_others_can_open() -> None:
    """It is served on all addresses, and its URL has one of them, or the computer's name."""
    with PageServer("0.0.0.0", 0, _DeskOfOneView()) as server:  # noqa: S104  # what is tested
        assert "0.0.0.0" not in server.url  # noqa: S104  # what is tested
        assert ask(port_of(server), "GET", "/state", Host=server.url.split("/")[2])[0] == 200


def test_it_ends_though_browsers_wait() -> None:
    """Nobody has to close a browser first."""
    with PageServer("127.0.0.1", 0, _DeskOfOneView()) as server:
        sock = socket.create_connection(("127.0.0.1", port_of(server)))
        begin = time.monotonic()
    assert time.monotonic() - begin < PATIENCE_S / 10  # a silent browser is cut off only after 20 s
    sock.close()
