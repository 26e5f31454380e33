"""The page of the link: who may read it, what it costs, and what it judges."""

from __future__ import annotations

import json
import logging
import re
import socket
import time
import urllib.error
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import pytest
from polling import PATIENCE_S, wait_until
from programs import Start
from visits import Events, ask, port_of

from bench.watched_link import WatchedLink, watched_link
from generated.registry import REGISTRY
from roverlink.link_page.event_clients import CLIENTS
from roverlink.link_page.last_values import LastValues, flat, values_of
from roverlink.link_page.link_server import LinkServer
from roverlink.link_page.live_page import LivePage
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.middleware.tapping import TappedMiddleware


@pytest.fixture(scope="module")
def link() -> Iterator[WatchedLink]:
    with watched_link() as made:
        yield made


def _row(state: dict[str, Any], name: str) -> dict[str, Any]:
    return next(row for row in state["rows"] if row["name"] == name)


@pytest.mark.slow
def test_the_events_show_rows_values_and_log(link: WatchedLink) -> None:
    """A message of a board is counted in its row, its values are those that were sent, and a bad datagram is logged."""
    with Events(link.url) as events:
        link.command()
        link.send_payload("imu_info", accel_x=1.5)
        values = events.until("values", lambda values: "imu_info" in values["rows"])
        assert values["rows"]["imu_info"]["accel_x"] == 1.5
        state = events.until("state", lambda state: _row(state, "imu_info")["count"])
        basestation, hardware = sorted(state["peers"], key=lambda peer: peer["name"])
        assert hardware["state"] == "alive"
        boards = {board["name"]: board["state"] for board in hardware["boards"]}
        assert boards == {"SensorBoard": "alive", "ArmBoard": "never", "DrivingBoard": "never"}
        assert basestation["boards"] == []
        link.send(b"\xff\xff")
        bad = "not a valid PBEnvelope"
        events.until("log", lambda log: any(bad in line["text"] for line in log["lines"]))
        events.until("state", lambda state: state["node"].get("dropped.malformed"))

    def history(row: str, field: str) -> list[float]:
        answer = ask(link.url, f"/history?bridge=/udp_forwarder&row={row}&field={field}")[1]
        return [value for _, value in json.loads(answer)["points"]]

    assert history("imu_info", "accel_x") == [1.5]
    ages = history("imu_info", "%23age")
    assert ages
    assert min(ages) >= 0
    assert history("no_row", "x") == []


def test_the_page_names_no_other_site(link: WatchedLink) -> None:
    """The page, its style and its program come from the bridge, so the page works without a network."""
    for path in ("/", "/page.css", "/page.js"):
        status, body = ask(link.url, path)
        assert status == 200
        assert not re.search(rb"""https?:|["'(]//|@import""", body)


_HISTORY = "/history?bridge=/udp_forwarder&row=imu_info&field=accel_x"


@pytest.mark.parametrize(
    ("headers", "statuses"),
    [
        *(({"Host": host}, [403] * 4) for host in ("evil.example", "localhost.evil.example", "127.0.0.1.evil", "")),
        ({"Origin": "http://evil.example"}, [403, 403, 200, 200]),
        ({"Origin": "null"}, [403, 403, 200, 200]),
        ({"Sec-Fetch-Site": "cross-site"}, [403, 403, 200, 200]),
    ],
)
def test_another_site_reads_no_data(link: WatchedLink, headers: dict[str, str], statuses: list[int]) -> None:
    """It may link to the page, but gets neither events nor histories, and so holds no connection.

    A site whose own name resolves to this computer sees nothing (DNS rebinding).
    """
    paths = ("/events", _HISTORY, "/", "/page.js")
    assert [ask(link.url, path, **headers)[0] for path in paths] == statuses


def test_the_page_only_reads(link: WatchedLink) -> None:
    """No method but GET has an effect, and no other file is served."""
    for method in ("POST", "PUT", "DELETE"):
        assert ask(link.url, "/", method)[0] == 501
    for path in ("/link_server.py", "/../__init__.py", "/state"):
        assert ask(link.url, path)[0] == 404
    with socket.create_connection(("127.0.0.1", port_of(link.url)), PATIENCE_S) as sock:
        sock.sendall(b"GET http://[ HTTP/1.1\r\nHost: localhost\r\n\r\n")
        assert sock.recv(100).startswith(b"HTTP/1.1 400 ")


@pytest.mark.slow
def test_thirty_browsers_follow_and_the_next_is_told() -> None:
    """The limit holds, the answer names the reason, and there is room again when a browser leaves."""
    with ExitStack() as stack:
        link = stack.enter_context(watched_link())
        last = ExitStack()
        followers = [(stack if number else last).enter_context(Events(link.url)) for number in range(CLIENTS)]
        for follower in followers:
            assert follower.next("state")
        status, body = ask(link.url, "/events")
        assert (status, body.startswith(b"30 browsers show this page already")) == (503, True)
        assert ask(link.url, "/")[0] == 200
        last.close()

        def has_room() -> bool:
            try:
                with Events(link.url):
                    return True
            except urllib.error.HTTPError:
                return False

        wait_until(has_room, "room for another browser")


def test_a_browser_that_does_not_read_is_dropped() -> None:
    """Its connection ends when its queue and the kernel's buffers are full; another browser gets every event."""
    page = LivePage(logging.getLogger("page"))
    event = b'event: big\ndata: "%s"\n\n' % (b"x" * 100_000)
    with LinkServer("127.0.0.1", 0, page) as server, socket.create_connection(("127.0.0.1", server.port)) as slow:
        slow.sendall(b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n")
        assert slow.recv(1) == b"H"
        with Events(server.url) as fast:
            fast.next("bridges")
            for _ in range(300):
                page.clients.send(event, {})
                assert fast.next("big") == "x" * 100_000
        slow.settimeout(PATIENCE_S)
        got, deadline = 0, time.monotonic() + PATIENCE_S
        while data := slow.recv(1_000_000):
            got += len(data)
            assert time.monotonic() < deadline, "the connection does not end"
        assert got < 300 * len(event)


def test_only_messages_on_topics_of_rows_have_values() -> None:
    """A listener on an extra topic would make the bridge convert. Bytes that are no message show no values."""
    handler = REGISTRY.by_name["imu_info"]
    values = LastValues({"/imu_data": "imu_info"})
    tapped = TappedMiddleware(MemoryMiddleware(Graph()), values)
    assert tapped.publisher("/imu_data", handler.message_type, handler.route.qos).has_subscribers()
    assert not tapped.publisher("/other", handler.message_type, handler.route.qos).has_subscribers()
    tap = values.topic("/imu_data", handler.message_type, handler.route.qos)
    assert tap is not None
    tap([b"\x00\x01"])
    assert values_of(values.changes()) == {}
    tap([cdr.encode(handler.message_type(accel_x=2.0))])
    assert values_of(values.changes())["imu_info"]["accel_x"] == 2.0
    assert values.changes() == {}


def test_messages_are_read_when_a_browser_asks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nobody follows: nothing is decoded. A browser that comes later sees the last values, and all numbers so far."""
    imu, read = REGISTRY.by_name["imu_info"], list[bytes]()
    decode = cdr.decode
    monkeypatch.setattr(cdr, "decode", lambda kind, data: read.append(data) or decode(kind, data))  # type: ignore[func-returns-value]
    page, values = LivePage(logging.getLogger("page")), LastValues({"/imu_data": "imu_info"})
    page.add("bridge", values)
    tap = values.topic("/imu_data", imu.message_type, imu.route.qos)
    assert tap is not None
    for number in range(5):
        tap([cdr.encode(imu.message_type(accel_x=number))])
        page.tick()
    assert read == []
    with LinkServer("127.0.0.1", 0, page) as server, Events(server.url) as events:
        assert events.next("values")["rows"]["imu_info"]["accel_x"] == 4
        tap([cdr.encode(imu.message_type(accel_x=5))])
        page.tick()
        assert events.next("values")["rows"]["imu_info"]["accel_x"] == 5
    for _ in range(2):
        points = page.history("bridge", "imu_info", "accel_x")["points"]
        assert [value for _, value in points] == [0, 1, 2, 3, 4, 5]
    assert len(read) == 8


def test_values_are_flat_and_bounded() -> None:
    """Paths name the fields; long arrays and texts are cut, and what JavaScript cannot hold is text."""
    values = flat({"a": {"b": [1, 2.5]}, "n": float("nan"), "i": 2**60, "t": "x" * 1000, "l": list(range(100))})
    assert (values["a.b[0]"], values["a.b[1]"], values["n"], values["i"]) == (1, 2.5, "nan", str(2**60))
    assert (len(values["t"]), values["l[]"], "l[16]" in values) == (200, "100 elements", False)
    assert len(flat({f"f{number}": number for number in range(1000)})) == 100


@pytest.mark.slow
def test_run_serves_the_page(start: Start) -> None:
    """`run --page` tells the address, serves the page there, and ends with it."""
    ros = ("--ros-args", "-p", "listen_port:=0")
    program = start("run", "--middleware", "memory", "--no-diagnostics", "--page", "127.0.0.1:0", *ros)
    with Events(program.wait_for("page: ").rpartition(" ")[2]) as events:
        assert events.next("state")["node"]["name"] == "udp_forwarder"
        assert program.interrupt() == 0
